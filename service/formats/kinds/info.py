"""What an installation is, as terminal text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def text(result: Mapping[str, Any]) -> str:
    """Device, versions and catalogue, a line each."""
    lines = [f"{name:<26}{value}" for part in ("device", "versions") for name, value in result[part].items()]
    for kind in ("models", "techniques"):
        lines += ["", kind]
        for entry in result["catalogue"][kind]:
            lines.append(f"  {entry['name']:<16}{entry['title']}")
            for name, parameter in entry["parameters"].items():
                unit = f" {parameter['unit']}" if parameter["unit"] else ""
                lines.append(
                    f"  {'':<16}  {name}, {parameter['min']:g} to {parameter['max']:g}{unit}: {parameter['help']}"
                )
    return "\n".join(lines) + "\n"
