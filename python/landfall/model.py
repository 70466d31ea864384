# SPDX-License-Identifier: GPL-3.0-or-later
"""The pipeline as a function from configuration values to metrics, for engines of sensitivity analysis and design.

    from landfall.model import model, openturns_function
    of = model({"terrain": "preset:paper", "scan": "preset:paper"}, ["scan.noise.range_sigma_m"], ["accuracy.relative.z.max_m"])
    of([0.01])                    # a vector of metrics
    openturns_function(of)        # openturns.Function; needs python3-openturns

docs/user/studies/model.md explains it. The engines are not part of landfall: OpenTURNS, Optuna, Dakota.
"""
from landfall.answers.model import model, openturns_function, optuna_objective

__all__ = ["model", "openturns_function", "optuna_objective"]
