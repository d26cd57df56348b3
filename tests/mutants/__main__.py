"""python tests/mutants [--passed] [WORD ...]: run the gate, or its mutants that hold all words.

With --passed the tests are not tried on the library as it is: they have just passed in this copy.
"""

from __future__ import annotations

import sys
from time import perf_counter

import gate


def main(words: list[str]) -> int:
    """0 when each mutant is killed, 1 else."""
    passed, words = "--passed" in words, [word for word in words if word != "--passed"]
    chosen = [
        mutant
        for mutant in gate.mutants()
        if all(word in f"{mutant} {mutant.kind}" for word in words)
    ]
    start = perf_counter()
    try:
        verdicts = gate.judge(chosen, passed=passed)
    except ValueError as error:
        print(error)
        return 1
    alive = [
        f"{found.outcome}: {mutant}"
        for mutant, found in verdicts.items()
        if found.outcome != "killed"
    ]
    killed = len(chosen) - len(alive)
    print(f"\n{killed} of {len(chosen)} mutants killed in {perf_counter() - start:.0f} s")
    print("\n".join(alive) if alive else "survivors: none")
    return 1 if alive or not chosen else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
