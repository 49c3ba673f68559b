"""Files that are not texts: HDF5, MATLAB, Parquet, TDMS, workbooks."""
