"""Does the tolerance hold for wings that nobody tuned to? Random wings against runs at a hundredth of it.

    python -m tests.benchmark.campaign [--wings 100] [--first 0] [--jobs 2] [--limit 120] [--tolerance T] [--stops]
        [--out CSV]

Every wing runs at a tolerance of its own, between 1e-2 and 1e-6, unless one is given for all; with --stops they have
end stops in place of most latches. A line each: seed,
bodies, how many of them are flexible, whether the base is free, latches from the base outwards (spring, table,
kinematic, none), tolerance, steps of both runs, largest error over tolerance by group, what went wrong. --limit is
the processor time (s) of a run with its repetitions. Where it was repeated at a smaller tolerance, the reference is a
tenth of that if this is less. Where the reference fails, a run at a tenth of the tolerance takes its place; errors
against it are told, not counted. A number of which the reference and a run at three times its tolerance differ by ten
tolerances of the run as well has no answer that a tolerance settles, as where the motion is chaotic: wings that miss
in nothing else are counted apart. Then a summary, of what is done where it is interrupted.
"""

from __future__ import annotations

from argparse import ArgumentParser
from contextlib import suppress
from pathlib import Path

from tests.benchmark.campaign.trials import HEAD, campaign, kept_in, row, summary


def main() -> None:
    """Run the campaign and print it as it comes."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--wings", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=120.0)
    parser.add_argument("--tolerance", type=float)
    parser.add_argument("--stops", action="store_true")
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args()
    trials = []
    print(HEAD)
    seeds = range(chosen.first, chosen.first + chosen.wings)
    found = campaign(seeds, chosen.tolerance, chosen.limit, chosen.jobs, stops=chosen.stops)
    with kept_in(chosen.out) as keep, suppress(KeyboardInterrupt):
        for trial in found:
            keep(trial)
            trials.append(trial)
            print(row(trial), flush=True)
    print("\n" + "\n".join(summary(trials)), flush=True)
    found.close()


if __name__ == "__main__":
    main()
