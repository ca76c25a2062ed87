"""Every rule, in the order of its code."""

from typing import Final

from executive.engine.lint import data_rules, loop_rules, order_rules, shape_rules, skill_rules
from executive.engine.lint.findings import Rule

RULES: Final[tuple[Rule, ...]] = (
    order_rules.UNREACHABLE,
    order_rules.CONSTANT,
    order_rules.ASKED_ONCE,
    order_rules.RESTARTED,
    loop_rules.UNREPEATABLE,
    shape_rules.ONE_CHILD,
    loop_rules.WITHOUT_EFFECT,
    shape_rules.TOO_DEEP,
    shape_rules.NEVER_HALTED,
    loop_rules.LATE_TIMEOUT,
    loop_rules.PAST_MISSION,
    loop_rules.IDLE_COOLDOWN,
    data_rules.PARALLEL_WRITERS,
    data_rules.NEVER_READ,
    data_rules.UNUSED_INPUT,
    data_rules.UNCERTAIN_OUTPUT,
    skill_rules.NO_STOP,
    shape_rules.NAMES,
)
WAIVER_CODE: Final = "L901"
WAIVER_RULE: Final = "waiver"
WAIVER_ABOUT: Final = (
    "A waiver `# lint: allow CODE because REASON` without a reason, for a code that no rule has, "
    "or where nothing is found."
)
