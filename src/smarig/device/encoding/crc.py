"""CRC-16/MODBUS by a table: reflected polynomial 0xA001, start value 0xFFFF."""


def _entry(byte: int) -> int:
    for _ in range(8):
        byte = byte >> 1 ^ (0xA001 if byte & 1 else 0)
    return byte


_TABLE = tuple(map(_entry, range(256)))


def crc16(data: bytes) -> int:
    """The check word of bytes.

    >>> f"{crc16(b'123456789'):04X}"
    '4B37'
    """
    crc = 0xFFFF
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc
