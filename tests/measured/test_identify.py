"""Numbers of lines found again on synthetic benches, with intervals that hold, twins, and what cannot be known."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from measured.benches import guess, part, random_line, recorded
from scipy.optimize import minimize_scalar

import trunnion as tn
from trunnion.design.optimisation.space import Space
from trunnion.equations.coefficients import assemble
from trunnion.measured.run_response import RunResponse, run_response

NAMES = ("joint.angle", "tube.stiffness", "tube.damping")


def truth(line: tn.Driveline) -> np.ndarray:
    return np.array([part(line, "joint").angle, part(line, "tube").torsional_stiffness, part(line, "tube").damping])


def found_on(seed: int) -> tuple[np.ndarray, tn.Identification]:
    rng = np.random.default_rng(seed)
    line = random_line(rng)
    wrong, free = guess(rng, line)
    return truth(line), tn.identify(wrong, recorded(line, seed), free)


@pytest.mark.slow
def test_a_line_is_found_again() -> None:
    true, found = found_on(3)
    assert found.parameters == NAMES
    assert np.all(np.abs(found.value - true) < 3.5 * found.deviation)
    off = np.abs(found.value / true - 1)
    assert np.rad2deg(abs(found.value[0] - true[0])) < 0.2 and off[1] < 0.02 and off[2] < 0.2
    assert 0.9 < found.chi_square / found.freedom < 1.15 and found.scale == 1.0
    assert np.all(np.abs(found.residual[1:] - 1) < 0.25)
    # The profile of a good measurement is a parabola, as wide as Fisher's information says.
    half = (found.high - found.low) / 2 / 1.96
    assert np.all(np.abs(half / found.deviation - 1) < 0.05)
    assert [str(one).partition(":")[0] for one in found.changes] == ["joint, angle", "tube, stiffness", "tube, damping"]
    assert found.changes[0].after.endswith(" deg"), "an updated file keeps the units that it was written in"
    again = tn.loads(tn.dumps(found.line))
    assert np.allclose(truth(again), found.value, rtol=1e-4) and not found.twins


@pytest.mark.slow
def test_an_interval_is_that_of_a_scan() -> None:
    """One parameter, χ² written out from the response on the run, scanned: it rises by 3.84 where the interval ends."""
    line = random_line(np.random.default_rng(8))
    data = recorded(line, 8, calibrated=True)
    k = part(line, "tube").torsional_stiffness
    found = tn.identify(line, data, {"tube.stiffness": (k / 1.5, k * 1.5)})

    first, last = data.rotation.windows[0], data.rotation.windows[-1]
    low, high = (70.0 + 230.0 / 20.0 * at for at in (first.middle - first.half, last.middle + last.half))
    speed = data.speed[found.windows]

    def on_run(stiffness: float) -> RunResponse:
        moved = line.replace("tube", stiffness=stiffness)

        def respond(speed: np.ndarray) -> np.ndarray:
            response = tn.order_response(moved, speed, [1, 2])
            return response.rotation[:, :, [response.inertias.index(name) for name in ("hub", "out")]]

        return run_response(respond, low, high, 230.0 / 20.0, np.array([1.0, 2.0]))

    before = on_run(found.value[0]).unsure_at(speed)

    def chi_square(stiffness: float) -> float:
        run = on_run(stiffness)
        predicted = run.steady_at(speed) + run.lag(speed)
        columns = [data.column(name) for name in ("hub", "out")]
        measured = data.amplitude[found.windows][:, :, columns]
        deviation = np.hypot(data.deviation[found.windows][:, :, columns], before)
        tau = data.floor[:, columns] / np.sqrt(2)

        def at(angle: float) -> float:
            off = measured - predicted * np.exp(1j * np.array([1, 2]) * angle)[:, None]
            # Gaussian constants are marginalised: a dense covariance of each order and channel.
            total = 0.0
            for order in range(2):
                for channel in range(2):
                    own = np.diag(deviation[:, order, channel] ** 2) + tau[order, channel] ** 2
                    inverse = np.linalg.inv(own)
                    d = off[:, order, channel]
                    total += float((d.conj() @ inverse @ d).real)
            return total

        near = minimize_scalar(
            at, bounds=(found.begin - 0.05, found.begin + 0.05), method="bounded", options={"xatol": 1e-9}
        )
        return float(near.fun)

    best = chi_square(found.value[0])
    for end in (found.low[0], found.high[0]):
        assert chi_square(end) - best == pytest.approx(3.84, abs=0.12)
    for beside in (found.value[0] * 0.9999, found.value[0] * 1.0001):
        assert chi_square(beside) > best - 1e-3


@pytest.mark.slow
def test_wheels_may_be_unknown_too() -> None:
    """Without a reference run: constants over the speed are the wheels', what follows resonances is the line's."""
    rng = np.random.default_rng(5)
    line = random_line(rng)
    wrong, free = guess(rng, line)
    data = recorded(line, 5, calibrated=False)
    assert data.hidden.any()
    found = tn.identify(wrong, data, free)
    true = truth(line)
    assert np.rad2deg(abs(found.value[0] - true[0])) < 0.3
    assert np.all(np.abs(found.value - true) < 3.5 * found.deviation)
    # The reference run is worth something.
    with_run = tn.identify(wrong, recorded(line, 5), free)
    assert np.all(with_run.high - with_run.low < found.high - found.low)


@pytest.mark.parametrize("after", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_what_cannot_be_known_is_said_before_and_after(after: bool) -> None:
    line = random_line(np.random.default_rng(11))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36}, jitter=2e-6, pitch_error=0.0)
    # Of order 2 alone nothing tells the plane of the joint from where the input began.
    data = tn.track_orders(run, [2], line=line, reference="input")
    free = {"joint.angle": (-0.3, 0.3), "joint.plane": (-1.5, 1.5), "tube.stiffness": (1e3, 9e4)}
    known = tn.identifiability(line, data, free)
    assert known.unknowable.tolist() == [False, True, False]
    assert "joint.plane cannot be known" in str(known.findings[0])
    if not after:
        return
    found = tn.identify(line, data, free)
    plane = found.parameters.index("joint.plane")
    assert found.unknown.tolist() == [False, True, False]
    assert (found.low[plane], found.high[plane]) == (-1.5, 1.5)  # its likelihood is flat
    # The sign of an angle does not show in rotations.
    assert len(found.twins) >= 1
    assert any(twin["joint.angle"] == pytest.approx(-found.value[0], rel=1e-3) for twin in found.twins)
    words = " ".join(map(str, found.findings))
    assert "fit as well as the best" in words and "joint.plane is not known" in words


def test_the_next_pickup() -> None:
    """With the rear disk alone seen, the rear shaft's numbers are known better by a pickup on the hub."""
    line = random_line(np.random.default_rng(21))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "out": 36}, jitter=2e-6)
    data = tn.track_orders(run, [1, 2], line=line, reference="input")
    free = {"rear.stiffness": (1e4, 1e5), "out.inertia": (0.02, 0.3), "tube.stiffness": (5e3, 6e4)}
    known = tn.identifiability(line, data, free)
    assert known.pickups == ("hub",) and np.all(known.gain >= 1 - 1e-6) and known.gain.max() > 1.1
    both = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "out": 36, "hub": 36}, jitter=2e-6)
    more = tn.identifiability(line, tn.track_orders(both, [1, 2], line=line, reference="input"), free)
    assert np.all(more.deviation < 1.1 * known.deviation / known.gain[0] * 1.3)


def test_a_range_without_a_resonance_is_said() -> None:
    line = random_line(np.random.default_rng(2))
    run = tn.measure(line, (20.0, 40.0), 12.0, {"input": 36, "hub": 36}, jitter=2e-6)
    data = tn.track_orders(run, [1, 2], line=line, reference="input")
    known = tn.identifiability(line, data, {"tube.damping": (0.5, 80.0)})
    assert any("crosses a natural frequency" in str(one) for one in known.findings)


def test_pickups_that_are_reversed_or_swapped_are_noticed() -> None:
    line = random_line(np.random.default_rng(14))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36, "out": 36}, pitch_error=0.0)

    def said(channels: list[tn.PulseTrain]) -> str:
        found = tn.compare_measured(line, tn.track_orders(tn.Measurement(channels), [1, 2], line=line))
        return " ".join(map(str, found.findings))

    first, hub, out = run.pulses
    trains = {"teeth": 36, "pitch_error": 0.0}
    made = lambda train, at, back=False: tn.PulseTrain(  # noqa: E731
        train.times, trains["teeth"], at, at, pitch_error=0.0, reversed=back
    )
    assert "are they swapped?" in said([first, made(hub, "out"), made(out, "hub")])
    assert "hub fits better with its sign changed" in said([first, made(hub, "hub", True), out])
    assert "?" not in said([first, hub, out])


def test_what_no_number_explains_is_neither_known_nor_a_twin() -> None:
    """Of a disk that the line does not say to be excited: every value fits as well, and the line found stays whole."""
    disk = tn.Disk(inertia=0.3, name="hub")
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=5, name="tube"), disk])
    shaken = line.replace("hub", excitation=[{"order": 2, "amplitude": 5.0}])
    run = tn.measure(shaken, (60.0, 90.0), 3.0, {"hub": 30}, jitter=1e-7, pitch_error=0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        found = tn.identify(line, tn.track_orders(run, [2], line=line), {"hub.inertia": (0.01, 90.0)})
    assert found.unknown.tolist() == [True] and not found.twins and found.probability < 1e-6
    assert 0.01 <= part(found.line, "hub").inertia <= 90.0


@pytest.mark.slow
def test_a_model_that_is_not_the_line_is_said() -> None:
    line = random_line(np.random.default_rng(31))
    data = recorded(line, 31)
    stiff = line.replace("out", inertia=part(line, "out").inertia * 1.6)
    found = tn.identify(stiff, data, {"tube.damping": (0.5, 100.0)})
    assert found.probability < 1e-6 and found.scale > 10
    assert "does not explain the data" in " ".join(map(str, found.findings))


@pytest.mark.slow
def test_a_run_that_was_not_fitted() -> None:
    rng = np.random.default_rng(17)
    line = random_line(rng)
    wrong, free = guess(rng, line)
    found = tn.identify(wrong, recorded(line, 17), free, held_out=recorded(line, 18))
    assert found.held_out is not None and 0.85 < found.held_out < 1.15
    poor = tn.identify(wrong, recorded(line, 17), {"tube.damping": free["tube.damping"]}, held_out=recorded(line, 18))
    assert poor.held_out is not None and poor.held_out > 2


def test_the_distance_from_instability() -> None:
    """The factor of the angle at which the line becomes unstable, by the multipliers on both sides of it."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4, damping=0.8, name="front"),
            tn.Disk(inertia=0.5, name="hub"),
            tn.HookeJoint(angle="8 deg", name="joint"),
            tn.Shaft(stiffness=1e4, damping=0.8, name="tube"),
            tn.Disk(inertia=0.5, name="out"),
        ]
    )
    run = tn.measure(line, (90.0, 260.0), 15.0, {"input": 36, "hub": 36, "out": 36}, jitter=2e-6, pitch_error=0.0)
    data = tn.track_orders(run, [2], line=line, reference="input", window=4)
    speed = 158.114  # half the sum of both natural frequencies
    free = {"joint.angle": (0.05, 0.3), "tube.damping": (0.2, 3.0)}
    distance = tn.identify(line, data, free, tongue_at=[speed]).distance
    assert distance is not None and 1 < distance.low <= distance.limit <= distance.high < 4
    radius = [
        tn.stability(line.replace("joint", angle=float(np.deg2rad(8) * factor)), speed).spectral_radius
        for factor in (0.97 * distance.low, 1.03 * distance.high)
    ]
    assert radius[0] < 1 < radius[1], distance.sentence


def test_zero_needs_no_unit() -> None:
    """As a bound in a text; of a temperature it does, whose zero depends on it."""
    line = assemble(random_line(np.random.default_rng(1)))
    (one,) = Space(line, {"joint.angle": ("0", "20 deg")}).free
    assert one.low == 0.0 and one.high == pytest.approx(np.deg2rad(20.0))
    for text in ("-0", "+0.0", " 0 ", "0e3", ".0"):
        assert Space(line, {"joint.angle": (text, "20 deg")}).free[0].low == 0.0
    for text in ("1", "0,0", "00x", "0 N"):
        with pytest.raises(tn.InputError, match=r"joint\.angle = "):
            Space(line, {"joint.angle": (text, "20 deg")})


REFUSED = (
    ({"tube.stiffnes": (1.0, 2.0)}, "tube.stiffnes: is not a parameter of this driveline"),
    ({"tube.stiffness": (2e4, 1e4)}, "tube.stiffness = (20000.0, 10000.0): must be rising bounds"),
    ({"tube.stiffness": ()}, 'tube.stiffness = (): must be a low and a high bound; write free={"tube.stiffness": ('),
    ({"tube.stiffness": ("", "")}, "tube.stiffness = '': does not start with a number; write a stiffness"),
    ({"": (1.0, 2.0)}, "free: has an empty name of a parameter; parameters are: speed, "),
    ({}, 'free: must name one parameter or more; write free={"tube.stiffness": ('),
)


@pytest.mark.parametrize(("free", "said"), REFUSED)
def test_what_is_refused(free: dict[str, tuple[float, float]], said: str) -> None:
    line = random_line(np.random.default_rng(1))
    data = tn.track_orders(tn.measure(line, 100.0, 3.0, {"input": 36, "hub": 36}), [1, 2], line=line)
    with pytest.raises(tn.InputError) as caught:
        tn.identify(line, data, free)
    assert str(caught.value).startswith(said), str(caught.value)


def covered(seeds: range) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each bench: whether intervals hold, errors, and Fisher's deviations (bench, parameter)."""
    inside, errors, bounds = [], [], []
    for seed in seeds:
        true, found = found_on(seed)
        inside.append((found.low <= true) & (true <= found.high))
        errors.append((found.value - true) / np.array([np.deg2rad(1.0), true[1], true[2]]))
        bounds.append(found.deviation / np.array([np.deg2rad(1.0), true[1], true[2]]))
    return np.array(inside), np.array(errors), np.array(bounds)


def agrees(inside: np.ndarray, errors: np.ndarray, bounds: np.ndarray, low: float, high: float) -> None:
    share = inside.mean(axis=0)
    assert np.all((share >= low) & (share <= high)), share
    middle = np.median(np.abs(errors), axis=0)
    assert middle[0] < 0.2 and middle[1] < 0.02 and middle[2] < 0.2
    # The median of a normal error is 0.67 standard deviations.
    assert np.all(middle < 2 * 0.6745 * np.median(bounds, axis=0))


@pytest.mark.slow
def test_intervals_hold_on_a_few_benches() -> None:
    agrees(*covered(range(1000, 1020)), 0.75, 1.0)


@pytest.mark.study
@pytest.mark.slow
def test_intervals_hold_on_a_thousand_benches() -> None:
    agrees(*covered(range(1000)), 0.93, 0.97)


def test_the_input_and_a_disk_swapped_are_noticed() -> None:
    """The input, driven evenly, cannot move: the pickup that shows the motion stands elsewhere."""
    line = random_line(np.random.default_rng(4))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36}, jitter=1e-6, pitch_error=0.0)
    first, hub = run.pulses
    for places, swapped in ((("input", "hub"), False), (("hub", "input"), True)):
        trains = [
            tn.PulseTrain(train.times, 36, name=name, at=at, pitch_error=0.0)
            for train, name, at in zip((first, hub), ("first", "second"), places, strict=True)
        ]
        data = tn.track_orders(tn.Measurement(trains), [1, 2], line=line, reference="first")
        words = " ".join(map(str, tn.compare_measured(line, data).findings))
        assert ("are they swapped?" in words) is swapped


def test_what_can_be_known_is_of_the_line_as_it_stands() -> None:
    """The Cramér–Rao bound at the line written out from order_response; elsewhere in the bounds it may be far less."""
    line = random_line(np.random.default_rng(13))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36}, jitter=2e-6, pitch_error=0.0)
    data = tn.track_orders(run, [1, 2], line=line, reference="input", window=2)
    damping = part(line, "tube").damping
    known = tn.identifiability(line, data, {"tube.damping": (damping / 8, 8 * damping)}, begin=0.0)

    def hub(value: float) -> np.ndarray:
        answer = tn.order_response(line.replace("tube", damping=value), data.speed, [1, 2])
        return answer.rotation[:, :, answer.inertias.index("hub")]

    slope = (hub(1.001 * damping) - hub(0.999 * damping)) / (0.002 * damping)
    deviation = data.deviation[:, :, data.column("hub")]
    bound = 1 / np.sqrt(np.nansum(np.abs(slope / deviation) ** 2))
    assert known.deviation[0] == pytest.approx(bound, rel=0.02)
    assert float(known.share[0]) < 0.7 * bound / (8 * damping - damping / 8)


@pytest.mark.slow
def test_a_free_line_with_a_joint_angle() -> None:
    """Each line moves about a periodic motion of its own; the stiffness is found again."""

    def line(stiffness: float) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.Disk(inertia=2.0, name="motor", drive_share=1.0, excitation=[{"order": 1, "amplitude": 20.0}]),
                tn.Shaft(stiffness=3e4, damping=20.0),
                tn.Disk(inertia=0.3),
                tn.HookeJoint(angle="12 deg"),
                tn.Shaft(stiffness=stiffness, damping=15.0, name="tube"),
                tn.Disk(inertia=0.5, name="hub", load_torque=20.0),
            ],
            operation=tn.Operation(speed=100.0),
        )

    run = tn.measure(line(2e4), (60.0, 200.0), 8.0, {"motor": 36, "hub": 36}, jitter=1e-6, pitch_error=0.0)
    data = tn.track_orders(run, [1, 2], line=line(2e4), reference="motor")
    found = tn.identify(line(1.7e4), data, {"tube.stiffness": (1.2e4, 3e4)})
    assert found.low[0] < 2e4 < found.high[0] and abs(found.value[0] / 2e4 - 1) < 0.003


@pytest.mark.slow
def test_a_likelihood_that_is_not_gaussian_is_drawn_from() -> None:
    """Of a small angle order 2 knows the square: its density is that of a square whose root is taken, by quadrature."""
    line = random_line(np.random.default_rng(11)).replace("joint", angle="0.1 deg")
    line = line.replace("hub", excitation=[])
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36}, jitter=4e-6, pitch_error=0.0)
    data = tn.track_orders(run, [2], line=line, reference="input")
    free = {"joint.angle": (0.0, 0.1)}
    plain = tn.identify(line, data, free, begin=0.0)
    assert not plain.gaussian[0] and "joint.angle is not Gaussian" in " ".join(map(str, plain.findings))
    found = tn.identify(line, data, free, begin=0.0, draws=250)
    assert found.independent > 50 and "hold 95 % of draws" in str(found)

    angles = np.linspace(0.0, 3 * float(found.drawn_high[0]), 120)
    hub, deviation = (one[found.windows][:, 0, data.column("hub")] for one in (data.amplitude, data.deviation))
    floor = float(data.floor[0, data.column("hub")] / np.sqrt(2))
    covariance = np.diag(deviation**2) + floor**2
    inverse = np.linalg.inv(covariance)
    misfit = np.empty(len(angles))
    for k, angle in enumerate(angles.tolist()):
        off = hub
        if angle:
            response = tn.order_response(line.replace("joint", angle=angle), data.speed[found.windows], [2])
            off = hub - response.rotation[:, 0, response.inertias.index("hub")]
        misfit[k] = float((off.conj() @ inverse @ off).real)
    density = np.exp(-(misfit - misfit.min()) / 2)
    weight = np.append(0.0, np.cumsum(density[1:] + density[:-1]))
    for share, end in ((0.025, found.drawn_low[0]), (0.975, found.drawn_high[0])):
        assert np.interp(end, angles, weight / weight[-1]) == pytest.approx(share, abs=0.03)


@pytest.mark.slow
def test_both_signs_are_drawn() -> None:
    """Rotations do not show the sign of an angle: half of the draws have each."""
    line = random_line(np.random.default_rng(11))
    run = tn.measure(line, (70.0, 300.0), 8.0, {"input": 36, "hub": 36}, jitter=2e-6, pitch_error=0.0)
    data = tn.track_orders(run, [2], line=line, reference="input")
    found = tn.identify(line, data, {"joint.angle": (-0.3, 0.3)}, draws=120)
    assert found.twins and (found.draws > 0).mean() == pytest.approx(0.5, abs=0.2)
    low, high = np.quantile(np.abs(found.draws), (0.025, 0.975))
    ends = np.sort(np.abs([found.low[0], found.high[0]]))
    assert np.allclose([low, high], ends, atol=0.4 * (ends[1] - ends[0]) / 2)
