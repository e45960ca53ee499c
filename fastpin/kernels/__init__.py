"""Compiled code and BLAS: arrays and numbers in, arrays and a status code out."""
