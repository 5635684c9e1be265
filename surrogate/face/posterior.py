"""What a Gaussian process gives at scaled coordinates: means, variances as sums of parts, and derivatives of both."""

from abc import ABC, abstractmethod

from approximation.arrays import Array


class Posterior(ABC):
    """Distributions of p outputs over d inputs, asked for at B points in scaled coordinates, (d, B)."""

    @property
    @abstractmethod
    def parts(self) -> int:
        """Number of parts that the variance is the sum of."""

    @abstractmethod
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return mean and variance, (p, B) each.

        Parameters
        ----------
        t : ndarray, shape (d, B), scaled coordinates
        weights : ndarray, shape (parts, p), of the parts of the variance; None: no variance
        """

    @abstractmethod
    def slopes(self, t: Array) -> Array:
        """Return the derivatives of the means by the scaled coordinates, (d, p, B)."""

    @abstractmethod
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B).

        Parameters
        ----------
        t : ndarray, shape (d, B), scaled coordinates
        weights : ndarray, shape (parts, p), of the parts of the variance
        """
