"""Searches for the world in which the arm is farthest from its pose, with Optuna."""

from __future__ import annotations

from contextlib import closing

import optuna
from worlds import Worlds

TRIALS = 60


def main() -> None:
    """Prints the worst world that it finds."""
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=10))
    with closing(Worlds("campaign.xml")) as worlds:

        def error(trial: optuna.Trial) -> float:
            values: dict[str, float | str] = {}
            for parameter in worlds.parameters:
                name = parameter["name"]
                if "values" in parameter:
                    values[name] = trial.suggest_categorical(name, parameter["values"])
                else:
                    values[name] = trial.suggest_float(name, parameter["low"], parameter["high"])
            # The same seed: the same start pose in all worlds.
            answer = worlds.run(seed=1, **values)
            measured: float = answer["measurements"][0]["value"]
            return measured

        study.optimize(error, n_trials=TRIALS)
    print(f"the largest error in {TRIALS} worlds is {study.best_value:.4f} rad, in the world with")
    for name, value in study.best_params.items():
        print(f"  {name}={value}")


if __name__ == "__main__":
    main()
