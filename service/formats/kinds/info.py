"""What an installation is, as terminal text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

KINDS = ("models", "techniques")


def text(result: Mapping[str, Any]) -> str:
    """Device, versions, catalogue and presets, a line each."""
    lines = [f"{name:<26}{value}" for part in ("device", "versions") for name, value in result[part].items()]
    width = max(len(entry["name"]) for kind in KINDS for entry in result["catalogue"][kind]) + 2
    for kind in KINDS:
        lines += ["", kind]
        for entry in result["catalogue"][kind]:
            lines.append(f"  {entry['name']:<{width}}{entry['title']}{_made_for(entry)}")
            lines += [f"  {'':<{width}}  {_parameter(name, one)}" for name, one in entry["parameters"].items()]
    lines += ["", "presets", *(f"  {name:<{width}}{title}" for name, title in result["presets"].items())]
    return "\n".join(lines) + "\n"


def _made_for(entry: Mapping[str, Any]) -> str:
    """What a technique's line says of the models it is made for; nothing where that is any."""
    models = entry.get("models", "any")
    return "" if models == "any" else f", for {', '.join(models)}"


def _parameter(name: str, declared: Mapping[str, Any]) -> str:
    unit = f" {declared['unit']}" if declared["unit"] else ""
    span = f"{declared['min']:g} to {declared['max']:g}{unit}, default {declared['default']:g}"
    return f"{name}: {span}; {declared['help']}"
