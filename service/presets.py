"""Presets: named materials, as the part of a scene that says which model with which parameters.

A preset is one TOML file under shaders/presets/, with `title`, `source`, `model`, `parameters` and, where values of
several parameters belong together, `zip`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from service.catalogue import SHADERS
from service.errors import BadInput, Problem


def preset_names(folder: Path = SHADERS) -> list[str]:
    """Names of the presets there are."""
    return sorted(path.stem for path in (folder / "presets").glob("*.toml"))


def preset(name: str, folder: Path = SHADERS) -> Mapping[str, Any]:
    """The content of a preset's file; BadInput lists the names there are."""
    if name not in preset_names(folder):
        raise BadInput(Problem("preset", name, "one of " + ", ".join(preset_names(folder))))
    return tomllib.loads((folder / "presets" / f"{name}.toml").read_text(encoding="utf-8"))


def with_preset(name: str, scene: Mapping[str, Any]) -> dict[str, Any]:
    """The scene with the preset's model and parameters; parameters that the scene gives itself stay as given.

    A zipped group of which the scene gives a member itself falls apart: only what is left of it stays zipped.
    """
    content = preset(name)
    own = scene.get("parameters") or {}
    groups = [[member for member in group if member not in own] for group in content.get("zip", [])]
    return {
        **scene,
        "model": content["model"],
        "parameters": {**content["parameters"], **own},
        "zip": [*(group for group in groups if len(group) > 1), *(scene.get("zip") or [])],
    }
