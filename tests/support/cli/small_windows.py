"""``maulstick`` that plans any canvas of more than 40 pixels in windows of 32.

python -m tests.support.cli.small_windows plan …
"""

from functools import partial

from maulstick.cli import main
from maulstick.jobs.plan import inputs, prepare, prepared
from maulstick.planning.mural.planner import plan_mural

if __name__ == "__main__":
    prepare.LONGEST_PX = inputs.LONGEST_PX = 40
    prepared.plan_mural = partial(plan_mural, window_px=32)
    main()
