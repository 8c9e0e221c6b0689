"""What this installation is: device, driver, versions and the catalogue. The text to put into a bug report."""

from __future__ import annotations

import platform
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from service.catalogue import Catalogue, Entry, load_catalogue
from service.engine import Engine
from service.presets import preset, preset_names


def describe(device: str | None = None) -> dict[str, Any]:
    """A result of kind `info`: opens the device, and raises as `Engine.open` does."""
    with Engine.open(device=device) as engine:
        return {
            "kind": "info",
            "device": asdict(engine.device.info),
            "versions": {
                "samplerscope": version("samplerscope"),
                "python": platform.python_version(),
                "numpy": version("numpy"),
                "vulkan": version("vulkan"),
            },
            "catalogue": describe_catalogue(load_catalogue()),
            "presets": {name: preset(name)["title"] for name in preset_names()},
        }


def describe_catalogue(catalogue: Catalogue) -> dict[str, list[dict[str, Any]]]:
    """Models and techniques as their files declare them, as plain data."""
    return {
        "models": [_entry(entry) | {"anisotropic": entry.head.anisotropic} for entry in catalogue.models.values()],
        "techniques": [
            _entry(entry) | {"models": entry.head.models, "uses": entry.head.uses}
            for entry in catalogue.techniques.values()
        ],
    }


def _entry(entry: Entry) -> dict[str, Any]:
    head = entry.head
    return {
        "name": head.name,
        "title": head.title,
        "source": head.source,
        "parameters": {name: parameter.model_dump() for name, parameter in head.parameters.items()},
        "singular": head.singular,
        "black": head.black,
        "left_out": head.left_out,
    }
