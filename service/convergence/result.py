"""The answer to a convergence scene: cost, curves, slopes, times to the target, ranking and efficiency."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np

from service.convergence.cost import Cost, Loop, measure_costs
from service.convergence.curves import Array, Curve, quadrature_curve, sampled_curve
from service.convergence.efficiency import efficiency_table, require_swept
from service.convergence.fit import Fit, fit_power_law
from service.convergence.ranking import Contender, product_interval, rank
from service.convergence.scene import ConvergenceScene
from service.convergence.truth import Truth, series_truth
from service.engine import Engine
from service.left_out import Feature, error_curve_features, report
from service.plain_data import finite_or_none
from service.scene import Question, SeriesPlan
from service.statistics import Progress


def compute_convergence(question: Question, engine: Engine, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """Answer a question whose scene is a ConvergenceScene: the result of kind `convergence`, plain data for JSON.

    Raises as `service.statistics.compute_statistics` does.
    """
    scene = cast(ConvergenceScene, question.scene)
    require_swept(question, engine)
    begin = time.perf_counter()
    costs, built_ms = _costs(question, engine)
    advance = _counter(question, scene, progress)
    sampled = sum(method != "quadrature" for method in scene.estimators)
    curves = max(1, len(question.series) * len(scene.angles_deg) * sampled)
    series: list[dict[str, Any]] = []
    features: list[Sequence[Feature]] = []
    for plan in question.series:
        truth = series_truth(plan, scene, engine)
        for curve in _curves(plan, scene, engine, truth, advance):
            built_ms += curve.built_ms
            series.append(_series(plan, scene, curve, truth, costs[plan.technique.name], curves))
            features.append(error_curve_features(plan, curve.method))
    return {
        "kind": "convergence",
        "scene": scene.model_dump(mode="json"),
        "target_error": scene.target_error,
        "series": series,
        "ranking": _rankings(scene, series),
        "efficiency": efficiency_table(question, engine, costs),
        "left_out": report(features),
        "run": engine.run_block(
            begin,
            threads=engine.device.info.threads,
            repeats=next(iter(costs.values())).repeats,
            compile_ms=built_ms,
        ),
    }


def _costs(question: Question, engine: Engine) -> tuple[dict[str, Cost], float]:
    """What drawing and weighing one direction costs, for every technique of the scene; repeats interleaved."""
    plans = {plan.technique.name: plan for plan in question.series}
    loops = [Loop(plan.model, plan.technique, "sample") for plan in plans.values()]
    found, built_ms = measure_costs(engine, loops, progress=lambda *_: engine.pause())
    return dict(zip(plans, found, strict=True)), built_ms


def _counter(question: Question, scene: ConvergenceScene, progress: Progress) -> Callable[[str], Callable[[int], None]]:
    sampled = sum(method != "quadrature" for method in scene.estimators)
    total = len(question.series) * sampled * len(scene.angles_deg) * scene.replicates * scene.counts[-1]
    done = 0

    def named(name: str) -> Callable[[int], None]:
        def advance(samples: int) -> None:
            nonlocal done
            done += samples
            progress(name, min(done, total), max(total, 1))

        return advance

    return named


def _curves(
    plan: SeriesPlan,
    scene: ConvergenceScene,
    engine: Engine,
    truth: Truth,
    advance: Callable[[str], Callable[[int], None]],
) -> list[Curve]:
    return [
        quadrature_curve(plan, scene, engine, truth)
        if method == "quadrature"
        else sampled_curve(plan, scene, engine, method, truth, advance(f"{plan.technique.name} {method}"))
        for method in scene.estimators
    ]


def _series(
    plan: SeriesPlan, scene: ConvergenceScene, curve: Curve, truth: Truth, cost: Cost, curves: int
) -> dict[str, Any]:
    """One series. `time_ms` is what a renderer pays, count x call_ns; `device_ms` what the estimator took here."""
    entry: dict[str, Any] = {
        "model": plan.model.name,
        "technique": plan.technique.name,
        "estimator": curve.method,
        "parameters": dict(plan.parameters),
        "theta_o_deg": list(scene.angles_deg),
        "samples": curve.counts,
        "replicates": curve.mean_errors.shape[1],
        "relative_rmse": [finite_or_none(row) for row in curve.mean_rmse],
        "variance_relative_rmse": [finite_or_none(row) for row in curve.variance_rmse],
        "call_ns": cost.call_ns,
        "call_ns_interval": list(cost.interval_ns),
        "call_ns_quartiles": list(cost.quartiles_ns),
        "empty_ns": cost.empty_ns,
        "time_ms": [count * cost.call_ns / 1e6 for count in curve.counts],
        "device_ms": curve.device_ms,
        "floor": finite_or_none(truth.floor),
        "efficiency": _efficiency(truth, cost),
        "verdict": _verdict(scene, truth),
    }
    if curve.method == "quadrature":
        return entry
    bias = np.where(truth.floor > 0, truth.mean / truth.albedo - 1.0, 0.0)
    fit = fit_power_law(
        curve.counts, curve.mean_errors, bias, truth.kurtosis, scene.target_error, curves, curve.method == "mc"
    )
    return entry | _fitted(fit, cost)


def _efficiency(truth: Truth, cost: Cost) -> list[float | None]:
    relative = truth.variance / truth.albedo**2
    with np.errstate(divide="ignore"):
        found = 1e9 / (relative * cost.call_ns)
    return finite_or_none(np.where((relative > 1e-9) & np.isfinite(relative), found, np.nan))


def _fitted(fit: Fit, cost: Cost) -> dict[str, Any]:
    reached = np.isfinite(fit.count_to_target)
    times = np.where(reached, fit.count_to_target * cost.call_ns / 1e6, np.nan)
    intervals = [
        list(product_interval((low * 1e-6, high * 1e-6), cost.interval_ns)) if ok else None
        for ok, (low, high) in zip(reached, fit.count_interval.tolist(), strict=True)
    ]
    return {
        "slope": finite_or_none(fit.slope),
        "slope_interval": _pairs(fit.slope_interval),
        "count_to_target": finite_or_none(fit.count_to_target),
        "time_to_target_ms": finite_or_none(times),
        "time_to_target_interval_ms": intervals,
    }


def _pairs(rows: Array) -> list[list[float] | None]:
    return [row.tolist() if np.all(np.isfinite(row)) else None for row in rows]


def _verdict(scene: ConvergenceScene, truth: Truth) -> dict[str, Any]:
    """What keeps errors from falling: an infinite variance, a bias."""
    angles = np.array(scene.angles_deg)
    findings = []
    infinite, biased = np.isinf(truth.variance), truth.floor > 0
    if infinite.any():
        message = (
            "the variance is infinite: errors fall in jumps, slower than one over the square root of the count, and "
            "no slope and no time to a target can be given"
        )
        evidence: dict[str, Any] = {"theta_o_deg": angles[infinite].tolist()}
        findings.append({"name": "infinite-variance", "message": message, "evidence": evidence})
    if biased.any():
        floor = truth.floor[biased]
        message = f"errors do not fall below {floor.max():.3g} of the albedo, whatever the number of samples"
        evidence = {"theta_o_deg": angles[biased].tolist(), "floor": floor.tolist()}
        findings.append({"name": "biased", "message": message, "evidence": evidence})
    return {"status": findings[0]["name"] if findings else "ok", "findings": findings}


def _rankings(scene: ConvergenceScene, series: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For every set of parameters and angle: who reaches the target first with `mc`, which is what a renderer runs."""
    method = "mc" if "mc" in scene.estimators else scene.estimators[0]
    mine = [one for one in series if one["estimator"] == method and "slope" in one]
    groups: dict[str, list[dict[str, Any]]] = {}
    for one in mine:
        shared = {name: value for name, value in one["parameters"].items() if name in scene.parameters}
        groups.setdefault(repr(sorted(shared.items())), []).append(one)
    out = []
    for group in groups.values():
        for at, angle in enumerate(scene.angles_deg):
            contenders = [
                Contender(one["technique"], one["time_to_target_ms"][at], _tuple(one["time_to_target_interval_ms"][at]))
                for one in group
            ]
            names = {name: value for name, value in group[0]["parameters"].items() if name in scene.parameters}
            out.append({"parameters": names, "theta_o_deg": angle, "estimator": method, **rank(contenders)})
    return out


def _tuple(pair: list[float] | None) -> tuple[float, float] | None:
    return None if pair is None else (pair[0], pair[1])
