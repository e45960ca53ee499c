"""What compiled code runs on: the store of machine code, threads, BLAS and LAPACK. Imports nothing of fastpin."""
