"""Addresses of the registers of LabJack T4, T7 and T8 (LabJack, T-series datasheet: Modbus map).

Values are big-endian: FLOAT32 and UINT32 take two registers, UINT16 one. Checked against LabJack's published examples,
except those of the watchdog's strict mode and DACs: arming reads them back, and the bring-up lets the lease expire.
"""

PRODUCT_ID = 60000  # FLOAT32: 4, 7 or 8
FIRMWARE_VERSION = 60004  # FLOAT32
SERIAL_NUMBER = 60028  # UINT32
PRODUCTS = {4: "T4", 7: "T7", 8: "T8"}
DAC_FULL_SCALE_V = {4: 5.0, 7: 5.0, 8: 10.0}

AIN = 0  # FLOAT32, volts; the next channel 2 further
AIN_RANGE = 40000  # FLOAT32, volts; 2 per channel
AIN_NEGATIVE_CHANNEL = 41000  # UINT16; 199: ground; 1 per channel
AIN_RESOLUTION_INDEX = 41500  # UINT16; 0: default; 1 per channel
NO_READING = -9999.0  # an extended feature without a valid result

AIN_EF_READ_A = 7000  # FLOAT32; 2 per channel
AIN_EF_INDEX = 9000  # UINT32; 0: none; 2 per channel
AIN_EF_CONFIG_A = 9300  # UINT32; of a thermocouple: 1 for °C
AIN_EF_CONFIG_B = 9600  # UINT32; of a thermocouple: address of the cold junction's temperature
COLD_JUNCTION = 60052  # temperature of the box
THERMOCOUPLES = {"E": 20, "J": 21, "K": 22, "R": 23, "T": 24}

DAC = 1000  # FLOAT32, volts; 2 per output

DIO_EF_READ_A = 3000  # UINT32; 2 per line
DIO_EF_ENABLE = 44000  # UINT32
DIO_EF_INDEX = 44100  # UINT32
QUADRATURE = 10  # index of the feature, on both lines of a pair
PAIRS = {4: (4, 6, 8), 7: (0, 2, 6), 8: (0, 2, 4, 6)}  # first line of each pair that has the feature

# The watchdog. All its registers are kept in flash, which wears out: they are written only if they differ.
WATCHDOG_ENABLE = 61600  # UINT32
WATCHDOG_TIMEOUT_S = 61604  # UINT32, whole seconds
WATCHDOG_STRICT_ENABLE = 61610  # UINT32; 0: any request to the box restarts its time
WATCHDOG_RESET_ENABLE = 61620  # UINT32; 1: the box restarts when the time is over
WATCHDOG_DAC_ENABLE = 61640  # UINT32; 10 per output
WATCHDOG_DAC = 61642  # FLOAT32, volts; 10 per output
