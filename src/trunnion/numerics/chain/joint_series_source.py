"""Taylor coefficients in time of the speed ratios of a chain's joints, for sixteen lanes at a time (source text).

With θ the input angle since ``begin`` in units of ``unit`` and C = cos 2χ, S = sin 2χ at a joint's input,

    C′ = −2χ′S,   S′ = 2χ′C,   D = 1 − sin²β (1 + C)/2,   ηD = cos β,   ψ′ = ηχ′,

each of which gives the next coefficient from those before it by one product of series (Moore 1966). Only
the values at ``begin`` need a sine and a cosine.

Products are written out term by term: loops over their few terms cost several times the work itself.
"""

from __future__ import annotations

from trunnion.numerics.chain.chain_tables import LANES

ORDER = 16
"""Order of the series: a step is then some 1.6 rad of the fastest motion at 1e-10, and cost per radian is flat."""
COS_IN, SIN_IN, SPEED_IN, OWN_RATIO, GROUP_RATIO = range(5)

_TEXT = """\
@njit(cache=True, nogil=True)
def empty_series(program):
    joints = max(1, len(program.joint_rate))
    return np.zeros(joints * PER_SERIES), np.zeros(joints * PER_START)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def joint_series(program, block, begin, unit, series, start):
    used = 1 if block.alike else LANES
    wound = False
    for j in range(len(program.joint_rate)):
        wound = wound or (program.joint_speed_source[j] >= 0 and abs(program.joint_rate[j]) != 1.0)
    for j in range(len(program.joint_rate)):
        own = series[j * PER_SERIES : (j + 1) * PER_SERIES]
        joint = block.joint[j * PER_JOINT : (j + 1) * PER_JOINT]
        leaves = start[j * PER_START : (j + 1) * PER_START]
        source, rate = program.joint_speed_source[j], program.joint_rate[j]
        if source < 0:
            _begin_on_drive(joint, used, begin, rate, own, leaves)
            driven_at_constant_speed(used, rate * unit, own)
        else:
            before = series[source * PER_SERIES : (source + 1) * PER_SERIES]
            _begin_on_joint(joint, start[source * PER_START : (source + 1) * PER_START], used, rate, own, leaves)
            series_product(before, OWN_RATIO * ROWS, before, SPEED_IN * ROWS, used, rate, own, SPEED_IN * ROWS)
            driven_at_varying_speed(used, own)
        ratio_series(joint, used, own)
        _output(joint, used, own, leaves)
        if wound:
            _output_angle(joint, used, own, leaves)
        group, factor = program.joint_ratio_source[j], program.joint_ratio[j]
        if group < 0:
            for k in range((ORDER + 1) * LANES):
                own[GROUP_RATIO * ROWS + k] = factor * own[OWN_RATIO * ROWS + k]
        else:
            above = series[group * PER_SERIES : (group + 1) * PER_SERIES]
            series_product(own, OWN_RATIO * ROWS, above, GROUP_RATIO * ROWS, used, factor, own, GROUP_RATIO * ROWS)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def near_rows(program, block, series, i, rows):
    scale = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * LANES : i * PER_UNKNOWN + (NEAR_SCALE + 1) * LANES]
    source = program.near_source[i]
    if source < 0:
        for lane in range(LANES):
            rows[lane] = scale[lane]
        return
    ratio = series[source * PER_SERIES + GROUP_RATIO * ROWS : source * PER_SERIES + (GROUP_RATIO + 1) * ROWS]
    for k in range(ORDER + 1):
        if block.alike:
            shared = ratio[k * LANES]
            for lane in range(LANES):
                rows[k * LANES + lane] = scale[lane] * shared
        else:
            for lane in range(LANES):
                rows[k * LANES + lane] = scale[lane] * ratio[k * LANES + lane]


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _begin_on_drive(joint, used, begin, rate, own, leaves):
    angle = 2 * rate * begin
    c, s = math.cos(angle), math.sin(angle)
    for lane in range(used):
        turn_c, turn_s = joint[TURN_COS * LANES + lane], joint[TURN_SIN * LANES + lane]
        own[COS_IN * ROWS + lane] = c * turn_c - s * turn_s
        own[SIN_IN * ROWS + lane] = s * turn_c + c * turn_s
        leaves[ANGLE_OUT * LANES + lane] = rate * begin + joint[PHASE * LANES + lane]


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _begin_on_joint(joint, before, used, rate, own, leaves):
    for lane in range(used):
        chi = rate * before[ANGLE_OUT * LANES + lane] + joint[PHASE * LANES + lane]
        leaves[ANGLE_OUT * LANES + lane] = chi
        if rate == 1.0 or rate == -1.0:
            turn_c, turn_s = joint[TURN_COS * LANES + lane], joint[TURN_SIN * LANES + lane]
            c, s = before[COS_OUT * LANES + lane], rate * before[SIN_OUT * LANES + lane]
            own[COS_IN * ROWS + lane] = c * turn_c - s * turn_s
            own[SIN_IN * ROWS + lane] = s * turn_c + c * turn_s
        else:
            # Behind such a ratio multiples of 2ψ do not suffice; ψ itself was kept.
            own[COS_IN * ROWS + lane], own[SIN_IN * ROWS + lane] = math.cos(2 * chi), math.sin(2 * chi)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _output(joint, used, own, leaves):
    for lane in range(used):
        cb, c, s = joint[COSINE * LANES + lane], own[COS_IN * ROWS + lane], own[SIN_IN * ROWS + lane]
        over = own[OWN_RATIO * ROWS + lane] / cb
        leaves[COS_OUT * LANES + lane] = 0.5 * (cb * cb * (1.0 + c) - (1.0 - c)) * over
        leaves[SIN_OUT * LANES + lane] = cb * s * over


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _output_angle(joint, used, own, leaves):
    for lane in range(used):
        cb, c, s = joint[COSINE * LANES + lane], own[COS_IN * ROWS + lane], own[SIN_IN * ROWS + lane]
        t = (1.0 - cb) / (1.0 + cb)
        leaves[ANGLE_OUT * LANES + lane] += math.atan2(t * s, 1.0 - t * c)
"""


def joint_series_source() -> str:
    """Functions ``empty_series``, ``joint_series`` and ``near_rows`` and what they need."""
    rows = (ORDER + 1) * LANES
    constants = [
        f"ORDER, ROWS, PER_SERIES, PER_START = {ORDER}, {rows}, {5 * rows}, {3 * LANES}",
        "COS_IN, SIN_IN, SPEED_IN, OWN_RATIO, GROUP_RATIO = 0, 1, 2, 3, 4",
        "COS_OUT, SIN_OUT, ANGLE_OUT = 0, 1, 2",
    ]
    made = [*constants, *_driven_at_constant_speed(), *_driven_at_varying_speed(), *_ratio(), *_product()]
    return "\n".join(made) + "\n\n\n" + _TEXT


def _driven_at_constant_speed() -> list[str]:
    lines = [f"{_of(SPEED_IN, 0)} = speed"]
    for k in range(ORDER):
        c, s = _of(COS_IN, k), _of(SIN_IN, k)
        lines.append(f"{_of(COS_IN, k + 1)} = -{2 / (k + 1)!r} * speed * {s}")
        lines.append(f"{_of(SIN_IN, k + 1)} = {2 / (k + 1)!r} * speed * {c}")
    return _function("driven_at_constant_speed(used, speed, own)", "used", lines)


def _driven_at_varying_speed() -> list[str]:
    """Cosine and sine from the speed, whose own series stands already."""
    lines = []
    for k in range(ORDER):
        for turned, other, sign in ((COS_IN, SIN_IN, "-"), (SIN_IN, COS_IN, "")):
            terms = " + ".join(f"{_of(SPEED_IN, m)} * {_of(other, k - m)}" for m in range(k + 1))
            lines.append(f"{_of(turned, k + 1)} = {sign}{2 / (k + 1)!r} * ({terms})")
    return _function("driven_at_varying_speed(used, own)", "used", lines)


def _ratio() -> list[str]:
    """η from ηD = cos β, where D_k = −½ sin²β C_k from the first order on."""
    lines = [
        "cb = joint[COSINE * LANES + l]",
        "s2 = 1.0 - cb * cb",
        f"e0 = cb / (1.0 - 0.5 * s2 * (1.0 + {_of(COS_IN, 0)}))",
        f"{_of(OWN_RATIO, 0)} = e0",
        "f = 0.5 * s2 / cb * e0",
    ]
    for k in range(1, ORDER + 1):
        terms = " + ".join(f"{_of(COS_IN, m)} * {_of(OWN_RATIO, k - m)}" for m in range(1, k + 1))
        lines.append(f"{_of(OWN_RATIO, k)} = f * ({terms})")
    return _function("ratio_series(joint, used, own)", "used", lines)


def _product() -> list[str]:
    lines = []
    for k in range(ORDER + 1):
        terms = " + ".join(f"a[ao + {m * LANES} + l] * b[bo + {(k - m) * LANES} + l]" for m in range(k + 1))
        lines.append(f"out[oo + {k * LANES} + l] = factor * ({terms})")
    return _function("series_product(a, ao, b, bo, used, factor, out, oo)", "used", lines)


def _function(signature: str, lanes: str, body: list[str]) -> list[str]:
    """Lines of a compiled function that does ``body`` for each of ``lanes`` lanes l."""
    head = ["", "", '@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")', f"def {signature}:"]
    return [*head, f"    for l in range({lanes}):", *("        " + line for line in body)]


def _row(quantity: int, k: int) -> str:
    return f"{(quantity * (ORDER + 1) + k) * LANES} + l"


def _of(quantity: int, k: int) -> str:
    return f"own[{_row(quantity, k)}]"
