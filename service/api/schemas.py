"""What responses look like, for the OpenAPI document. Responses may have more members than are listed here."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.catalogue import OWN_FILE_BYTES, Parameter
from service.worker.kinds import KINDS

Column = list[float | None]


class Axis(BaseModel):
    """How to label a column when it is plotted."""

    label: str
    unit: str
    scale: Literal["linear", "log"]


class Finding(BaseModel):
    """One thing that is known of a series."""

    name: str
    message: str
    evidence: dict[str, Any]


class Verdict(BaseModel):
    """What the numbers of a series mean; the status is `ok` or the name of the worst finding."""

    status: str
    findings: list[Finding]


class Reference(BaseModel):
    """Float64 truth, one value an angle; null where it is infinite."""

    mean: Column
    albedo: Column
    variance: Column
    max_weight: Column


class Series(BaseModel):
    """One curve: a technique at one set of parameter values. All columns have the length of `theta_o_deg`."""

    model: str
    technique: str
    parameters: dict[str, float]
    theta_o_deg: list[float]
    samples: int | list[int]
    mean: Column = []
    mean_stderr: Column = []
    variance: Column = []
    variance_stderr: Column = []
    max_weight: Column = []
    zero_fraction: Column = []
    nonfinite: list[int]
    reference: Reference | None
    verdict: Verdict
    device_ms: float


class LeftOut(BaseModel):
    """What shaders left out, the reason, and the numbers of the series whose shaders they are."""

    feature: str
    reason: str
    series: list[int]


class StatisticsResult(BaseModel):
    """Mean, variance and largest weight of every technique at every view angle."""

    kind: Literal["statistics"]
    scene: dict[str, Any]
    axes: dict[str, Axis]
    series: list[Series]
    left_out: list[LeftOut]
    run: dict[str, Any]


class ShaderFigures(BaseModel):
    """Size and speed of the shader that answers a series, on average over the series.

    `spirv_bytes` and `instructions` are after specialization, `module_bytes` before; `ns_per_sample` is time of one
    driver thread.
    """

    module_bytes: int
    spirv_bytes: int
    instructions: int
    compile_ms: float
    ns_per_sample: float


class Saving(BaseModel):
    """What leaving out one feature saves of the full shader, on average over the series."""

    ns_per_sample: float
    instructions: int


class ExplainedFeature(LeftOut):
    """What shaders left out, and what that saves by itself."""

    saves: Saving


class ExplainResult(BaseModel):
    """What the shaders of a scene leave out, measured beside those that keep everything."""

    kind: Literal["explain"]
    scene: dict[str, Any]
    series: list[dict[str, Any]]
    left_out: list[ExplainedFeature]
    variant: ShaderFigures
    full: ShaderFigures
    shaders: list[dict[str, Any]]
    run: dict[str, Any]


class AnyResult(BaseModel):
    """A result: its kind says what else it holds."""

    kind: str


class CatalogueEntry(BaseModel):
    """A model or technique as its file declares it."""

    name: str
    title: str
    source: str
    parameters: dict[str, Parameter]
    singular: list[str]
    black: dict[str, float]
    left_out: dict[str, dict[str, float]]


class CatalogueResult(BaseModel):
    """Every model and technique."""

    kind: Literal["catalogue"]
    models: list[CatalogueEntry]
    techniques: list[CatalogueEntry]


class Figure(BaseModel):
    """A figure of a paper."""

    name: str
    title: str
    chart: str
    scene: dict[str, Any]


class Figures(BaseModel):
    """The figures there are."""

    kind: Literal["figures"]
    figures: list[Figure]


class Progress(BaseModel):
    """Samples drawn, and to draw in all."""

    done: int = Field(ge=0)
    total: int = Field(ge=0)


class Links(BaseModel):
    """Paths that belong to a job."""

    self: str
    events: str
    result: str


class BadField(BaseModel):
    """One wrong field: its path, the value given, what is allowed."""

    field: str
    value: Any
    allowed: str


class Diagnostic(BaseModel):
    """One message of the shader compiler; the line is 0 where it belongs to none."""

    file: str
    line: int
    message: str


class Problem(BaseModel):
    """What went wrong (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    request_id: str = Field(description="The same id stands in the log of the server.")
    errors: list[BadField] = Field([], description="Every wrong field.")
    diagnostics: list[Diagnostic] = Field([], description="What the compiler says of shader text, by line.")
    estimate: float | None = Field(None, description="What the question would need, where that is above a limit.")
    limit: float | None = Field(None, description="That limit.")


class Job(BaseModel):
    """A question answered in the background."""

    id: str
    kind: Literal[tuple(KINDS)]  # type: ignore[valid-type]
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    progress: Progress
    estimate_s: float
    created: str
    updated: str
    error: Problem | None
    links: Links
    scene: dict[str, Any]


class Jobs(BaseModel):
    """The latest jobs."""

    kind: Literal["jobs"]
    jobs: list[Job]


class Health(BaseModel):
    """The server answers."""

    status: Literal["ok"]


class Ready(BaseModel):
    """The device computed what it should have."""

    ready: Literal[True]
    found: dict[str, float | None]
    known: dict[str, float]
    device: dict[str, Any]


class _OwnFile(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    glsl: str = Field(max_length=OWN_FILE_BYTES, description="The text of the file, as shaders/README.md says.")


class OwnCheck(_OwnFile):
    """A file to check, with the words of `samplerscope check`."""

    model: str | None = Field(None, description="The model for a technique. Default: eon, or the first it is made for.")
    techniques: list[str] | None = Field(None, min_length=1, description="For a model. Default: cosine and uniform.")
    parameters: dict[str, float] = Field({}, description="Parameters to fix, which are swept else.")
    quick: bool = Field(True, description="A few seconds, at the lower power that each check states.")
    seed: int = Field(0, ge=0, lt=2**63, description="Seed of the random numbers.")


class OwnScene(_OwnFile):
    """A file and a scene for it. The scene's `model` is the file's, and its parameters are the file's own as well."""

    scene: dict[str, Any] = Field({}, description="A scene, as for questions about the catalogue.")


MODELS: tuple[type[BaseModel], ...] = (
    StatisticsResult,
    ExplainResult,
    AnyResult,
    CatalogueResult,
    Figures,
    Jobs,
    Problem,
    OwnCheck,
    OwnScene,
    Health,
    Ready,
)
