"""What the battery must find in the catalogue, and why: the faults that the models and techniques are known to have.

The reasons are those of the heads, of docs/models.md and of the pages of claims. A pair with no row here is sound.
"""

from __future__ import annotations

from dataclasses import dataclass

from service.catalogue import Catalogue

OREN_NAYAR = ("lambert", "qon", "qon-footnote", "qon-fujii", "oren-nayar-full", "oren-nayar-tutorial")
EON = ("eon", "eon-approx", "fon")
EON_TECHNIQUES = ("ltc", "ltc-nonnegative", "cltc", "cltc-mis")
KURT = ("kurt", "kurt-coupled", "kurt-multilobe")


@dataclass(frozen=True)
class Fault:
    """Checks that must fail for all these models with all these techniques; no techniques means with any."""

    models: tuple[str, ...]
    techniques: tuple[str, ...]
    checks: tuple[str, ...]
    reason: str

    def holds_for(self, model: str, technique: str) -> bool:
        """Whether this pair has the fault."""
        return model in self.models and (not self.techniques or technique in self.techniques)


FAULTS = (
    Fault(("qon",), (), ("energy",), "albedo up to 1.0152 at grazing view, for sigma below 0.326"),
    Fault(("qon-footnote",), (), ("energy",), "albedo up to 1.0444 at grazing view"),
    Fault(("qon-fujii",), (), ("energy",), "albedo up to 1.0287 at grazing view"),
    Fault(("oren-nayar-full",), (), ("energy",), "albedo up to 1.0510 at grazing view"),
    Fault(
        ("oren-nayar-full",), (), ("nonnegative",),
        "negative in forward grazing scattering, for albedo below 0.837 at sigma pi/2",
    ),
    Fault(("oren-nayar-tutorial",), (), ("energy",), "polar angles where the azimuth belongs: albedo up to 1.289"),
    Fault(
        (*EON, *OREN_NAYAR), ("ltc", "cltc"), ("coverage", "unbiased", "tail", "supremum"),
        "the tilted lobe leaves a part at the horizon out, and P(w > W) falls like W^-2 towards it",
    ),
    Fault(KURT, (), ("energy",), "any alpha above 0 makes the albedo grow like cos^-alpha at grazing view"),
    Fault(KURT, ("cosine",), ("supremum",), "weights have no bound for any alpha above 0"),
    Fault(KURT, ("cosine",), ("tail",), "no variance for alpha from 1"),
    Fault(KURT, ("uniform",), ("tail", "supremum"), "no bound for alpha above 1, no variance from 1.5"),
    Fault(
        KURT, ("beckmann-half-vector", "kurt-multilobe"), ("tail", "supremum"),
        "no bound for alpha above 1, no variance from 1.5; with kd above 0 weights up to exp(((1 + sin)/(m cos))^2)",
    ),
    Fault(
        KURT, ("half-vector-cosine", "kurt-multilobe-cosine"), ("tail", "supremum"),
        "no bound for alpha above 1, no variance from 1.5",
    ),
    Fault(("kurt-plausible",), (), ("energy",), "albedo above 1 at grazing view for slopes above 1.881, up to 4.4"),
    Fault(("ward",), (), ("energy",), "albedo grows like cos^-1/2 at grazing view"),
    Fault(("ward",), ("cosine",), ("supremum",), "weights grow like cos^-1/2 towards the horizon"),
    Fault(("ward-duer",), (), ("energy",), "albedo grows like cos^-1 at grazing view"),
    Fault(("ward-duer",), ("cosine",), ("tail", "supremum"), "weights grow like cos^-1: no variance"),
    Fault(
        ("ggx",), ("ggx-half-vector",), ("supremum",),
        "a bound, but up to 1/(alpha cos), next to grazing towards the view; weights still grow where the search ends",
    ),
)  # fmt: skip


def expected(model: str, technique: str) -> set[str]:
    """Names of the checks that must fail for this pair, with the battery's full power."""
    return {check for fault in FAULTS if fault.holds_for(model, technique) for check in fault.checks}


def pairs(catalogue: Catalogue) -> list[tuple[str, str]]:
    """Every model with every technique made for it, and the EON paper's lobes on the other diffuse models."""
    usual = [(model, technique) for model in catalogue.models for technique in catalogue.techniques_for(model)]
    return usual + [(model, technique) for model in OREN_NAYAR for technique in EON_TECHNIQUES]


def table() -> str:
    """The faults as the table of docs/checks.md."""
    lines = ["| model | technique | fails | why |", "|---|---|---|---|"]
    lines += [
        f"| {_code(fault.models)} | {_code(fault.techniques) or 'any'} | {_code(fault.checks)} | {fault.reason} |"
        for fault in FAULTS
    ]
    return "\n".join(lines)


def _code(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)
