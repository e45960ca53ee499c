"""Convolutions over equally spaced nodes by fast Fourier transforms."""

from __future__ import annotations

import numpy as np

from fastpin.runtime.extensions import fft


def spectra(kernels: np.ndarray, signs: tuple[float, ...], closed: bool) -> tuple[int, np.ndarray]:
    """The period of convolutions with kernels of the distance of two nodes, and the transforms of the kernels.

    On a circle a convolution is periodic. On an arc its period has room for all distances of either sign.

    Parameters
    ----------
    kernels : ndarray, shape (k, n)
        Their values at the distances of 0 to n - 1 nodes.
    signs : tuple of float
        1 for an even kernel, whose transform is real; -1 for an odd one, whose transform is imaginary.
    closed : bool
        Whether the nodes go round the whole circle.

    Returns
    -------
    int, ndarray of shape (k, m)
    """
    n = kernels.shape[1]
    period = n if closed else fft.next_fast_len(2 * n - 1, real=True)
    whole = np.zeros((len(kernels), period))
    whole[:, :n] = kernels
    if not closed:
        whole[:, period - n + 1 :] = np.array(signs)[:, None] * kernels[:, :0:-1]
    return period, fft.rfft(whole, workers=1)
