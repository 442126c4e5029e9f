"""Taylor arithmetic against functions whose derivatives are known."""

import numpy as np
import pytest

from trunnion.laws.joint import through
from trunnion.numerics import jets

TIME = np.linspace(0.1, 1.3, 7)


def exponential(rate, order=5):
    """Jet of e^{rate·t}."""
    value = np.exp(rate * TIME)
    scale = np.cumprod([1.0, *(rate / k for k in range(1, order + 1))])
    return scale[:, None] * value


def test_product_and_quotient():
    assert np.allclose(jets.multiply(exponential(2.0), exponential(-0.5)), exponential(1.5), rtol=1e-13)
    assert np.allclose(jets.divide(exponential(2.0), exponential(-0.5)), exponential(2.5), rtol=1e-13)


def test_square_root():
    assert np.allclose(jets.square_root(exponential(3.0)), exponential(1.5), rtol=1e-13)


@pytest.mark.parametrize("rate", [1.0, -2.5])
def test_sine_and_cosine(rate):
    argument = np.zeros((6, 7))
    argument[0], argument[1] = rate * TIME, rate
    sine, cosine = jets.sine_cosine(argument)
    for k, (s, c) in enumerate(zip(sine, cosine, strict=True)):
        size = rate**k / np.prod(np.arange(1, k + 1))
        assert np.allclose(s, size * np.sin(rate * TIME + k * np.pi / 2), atol=1e-13)
        assert np.allclose(c, size * np.cos(rate * TIME + k * np.pi / 2), atol=1e-13)


def test_a_function_of_a_jet():
    """The logarithm of e^{rate·t}, order by order up to the highest that joints need."""
    jet = exponential(1.7, 4)
    derivatives = [np.log(jet[0]), *(factor / jet[0] ** k for k, factor in enumerate((1, -1, 2, -6), start=1))]
    found = through(derivatives, list(jet))
    assert np.allclose(found[:2], [1.7 * TIME, np.full(7, 1.7)], rtol=1e-13)
    assert np.allclose(found[2:], 0.0, atol=1e-13)


def test_rate():
    jet = exponential(1.7)
    assert np.allclose(jets.rate(jet), 1.7 * exponential(1.7, 4), rtol=1e-13)
    assert np.allclose(jets.constant(3.0, jet)[1:], 0)
    assert np.all(jets.constant(3.0, jet)[0] == 3)
