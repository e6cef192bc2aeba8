"""What is drawn: distributions and designs against their definitions, and what cannot be, told in sentences."""

import numpy as np
import pytest
from scipy.stats import norm

from orchestrator.analysis.sampling.distributions import StudyError, distribution
from orchestrator.analysis.sampling.plan import METHODS, Plan
from orchestrator.analysis.sampling.varied import varied

TWO = (varied("friction.coefficient=uniform(0.05, 0.2)"), varied("a.b,a.c*=normal(1, 0.03)"))


@pytest.mark.parametrize(
    ("text", "median", "low", "high", "upper"),
    [
        ("uniform(0.05, 0.25)", 0.15, 0.05, 0.25, 0.05 + 0.2 * 0.975),
        ("normal(1.65 N.m, 0.05 N.m)", 1.65, 1.5, 1.8, 1.65 + 0.05 * norm.ppf(0.975)),
        ("normal(1.65 N.m, 10 %)", 1.65, 1.155, 2.145, 1.65 + 0.165 * norm.ppf(0.975)),
        ("normal(3 %, 1 %)", 3.0, 0.0, 6.0, 3.0 + norm.ppf(0.975)),
        # area below the mode is half of the triangle
        ("triangular(0, 1, 2)", 1.0, 0.0, 2.0, 2.0 - np.sqrt(0.05)),
        ("truncated_normal(0, 1, -1, 1)", 0.0, -1.0, 1.0, norm.ppf(norm.cdf(-1) + 0.975 * (1 - 2 * norm.cdf(-1)))),
        ("values(3, 1, 2)", 2.0, 1.0, 3.0, 3.0),
        ("values(2, 1, 2, 2)", 2.0, 1.0, 2.0, 2.0),
    ],
)  # fmt: skip
def test_quantiles_are_those_of_the_definition(text, median, low, high, upper):
    """Closed forms: median, worst cases and the 97.5 % quantile."""
    found = distribution(text)
    assert found.nominal == pytest.approx(median, rel=1e-12)
    assert (found.low, found.high) == pytest.approx((low, high), rel=1e-12)
    assert found.quantile(np.array([0.975]))[0] == pytest.approx(upper, rel=1e-12)


@pytest.mark.parametrize("text", ["lognormal(0.15 N.m, 40 %)", "lognormal(5 %, 40 %)", "lognormal(1, 40 %)"])
def test_a_lognormal_has_its_mean_and_coefficient_of_variation(text):
    """Definition: standard deviation over mean by quadrature of the quantile function; closed form of the median."""
    found = distribution(text)
    mean = float(text.split("(")[1].split()[0].strip(","))
    drawn = found.quantile((np.arange(200_000) + 0.5) / 200_000)
    assert drawn.mean() == pytest.approx(mean, rel=1e-3)
    assert drawn.std() / drawn.mean() == pytest.approx(0.4, rel=1e-2)
    assert found.nominal == pytest.approx(mean / np.sqrt(1.0 + 0.4**2), rel=1e-12)
    assert np.log(found.high / found.nominal) == pytest.approx(3.0 * np.sqrt(np.log(1.16)), rel=1e-12)
    assert found.unit == text.split("(")[1].split(",")[0].partition(" ")[2]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gamma(1, 2)", "uniform(LOW, HIGH)"),
        ("0.1", "no distribution"),
        ("uniform(0.2, 0.1)", "second"),
        ("uniform(0.1)", "1 numbers"),
        ("uniform(a, 1)", "'a'"),
        ("uniform(nan, 1)", "'nan'"),
        ("uniform(1 N.m, 2)", "different units"),
        ("normal(1, 0)", "deviation"),
        ("triangular(0, 3, 2)", "must rise"),
        ("lognormal(2, 0.9)", " %"),
        ("lognormal(2, 0 %)", "positive"),
        ("lognormal(-2, 10 %)", "positive"),
    ],
)
def test_what_is_no_distribution_is_a_sentence(text, said):
    with pytest.raises(StudyError) as refused:
        distribution(text)
    assert said in str(refused.value)
    assert text in str(refused.value)


def test_factors_multiply_what_the_scene_has():
    """Definition: numbers, texts with units and lists of them, each under its own key."""
    tree = {
        "a": {"b": 2.0, "c": "4 N.m", "d": ["1 N.m", "3 N.m"], "z": "0 N"},
        "body": [{"name": "p", "m": 5}],
    }
    factor = varied("a.b,a.c,a.d,body.p.m*=uniform(0, 2)")
    assert factor.settings(tree, 0.5) == {
        "a.b": 1.0,
        "a.c": "2.0 N.m",
        "a.d": ["0.5 N.m", "1.5 N.m"],
        "body.p.m": 2.5,
    }
    assert varied("a.c=uniform(1 N.m, 2 N.m)").settings(tree, 1.5) == {"a.c": "1.5 N.m"}
    assert varied("a.n=values(5, 10)").settings(tree, 5.0) == {"a.n": 5}
    for text, said in (
        ("a.x*=uniform(0, 1)", "a.x: "),
        ("a.z*=uniform(0, 1)", "a.z: "),
        ("a*=uniform(0, 1)", "a: {"),
        ("a.b*=uniform(1 N, 2 N)", "unit"),
        ("a.b*,a.c*=uniform(1, 2)", "last key"),
        ("a.b", "KEY=DISTRIBUTION"),
    ):
        with pytest.raises(StudyError) as refused:
            varied(text).settings(tree, 1.0)
        assert said in str(refused.value)


@pytest.mark.parametrize("method", METHODS)
def test_a_plan_is_the_same_again_and_has_as_many_samples_as_it_says(method):
    plan, again = (Plan(TWO, method, runs=8, levels=3, seed=4) for _ in range(2))
    samples = plan.samples()
    assert samples.shape == (plan.count, 2)
    np.testing.assert_array_equal(samples, again.samples())
    assert (samples[:, 0].min() >= 0.05) & (samples[:, 0].max() <= 0.2)


def test_designs_are_what_they_are_called():
    """Definitions: one sample in each stratum, worst cases three deviations away, all combinations."""
    strata = np.sort((Plan(TWO, "latin-hypercube", runs=8).samples()[:, 0] - 0.05) / 0.15 * 8).astype(int)
    assert strata.tolist() == list(range(8))
    np.testing.assert_allclose(
        Plan(TWO, "one-at-a-time").samples(),
        [[0.125, 1], [0.05, 1], [0.2, 1], [0.125, 0.91], [0.125, 1.09]],
    )
    corners = Plan(TWO, "corners").samples()
    assert {tuple(np.round(row, 6)) for row in corners[1:]} == {
        (a, b) for a in (0.05, 0.2) for b in (0.91, 1.09)
    }
    grid = Plan((*TWO[:1], varied("n=values(1, 2, 5)")), "grid", levels=2).samples()
    assert grid.tolist() == [[a, b] for a in (0.05, 0.2) for b in (1.0, 2.0, 5.0)]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"varied": ()}, "varied"),
        ({"varied": TWO[:1] * 2}, "friction.coefficient: varied twice"),
        ({"method": "guess"}, "'guess'"),
        ({"method": "sobol", "runs": 100}, "64 or 128"),
        ({"method": "grid", "levels": 100_000}, "this takes 10,000,000,000 runs"),
        ({"runs": 0}, "0 runs"),
        ({"seed": -1}, "seed -1 is none"),
    ],
)
def test_what_is_no_plan_is_a_sentence(options, said):
    with pytest.raises(StudyError) as refused:
        Plan(**{"varied": TWO, **options})
    assert said in str(refused.value)


def test_values_that_stand_twice_are_drawn_twice_as_often():
    """Definition: repeats are weights; a grid has each level once."""
    found = distribution("values(0.1, 0.1, 0.1, 1.8)")
    drawn = found.quantile((np.arange(40) + 0.5) / 40)
    assert (np.sum(drawn == 0.1), np.sum(drawn == 1.8)) == (30, 10)
    assert found.spread(5).tolist() == [0.1, 1.8]
