"""Makes numpy take the kernels that frozen answers were made with; import it before numpy.

With kernels for AVX-512, optimisations end 1e-5 apart. With several threads, workers fight for the cores.
"""

import os
import warnings
from importlib import import_module
from pathlib import Path

CPU = Path("/proc/cpuinfo")

os.environ.setdefault("OMP_NUM_THREADS", "1")
if CPU.is_file() and " avx512f " in CPU.read_text(encoding="utf-8", errors="replace"):
    os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")
    os.environ.setdefault("NPY_DISABLE_CPU_FEATURES", "X86_V4")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImportWarning)  # a numpy that calls them by other names keeps them
        import_module("numpy")
