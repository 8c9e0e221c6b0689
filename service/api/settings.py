"""Settings of the server, each from an environment variable SAMPLERSCOPE_NAME or from its default."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import platformdirs
from pydantic import Field, SecretStr, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from service.errors import BadInput, Problem, allowed_in_words

# Clocks end somewhere: no time is longer than 30 years.
Seconds = Annotated[float, Field(gt=0, le=1e9)]
SecondsFrom0 = Annotated[float, Field(ge=0, le=1e9)]


class Settings(BaseSettings):
    """Every setting. Sizes are bytes, names that end in _s are seconds."""

    model_config = SettingsConfigDict(env_prefix="SAMPLERSCOPE_", frozen=True, extra="ignore", allow_inf_nan=False)

    host: str = Field("127.0.0.1", min_length=1, description="Address to listen on.")
    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0 takes a free one.")
    api_key: SecretStr | None = Field(
        None, min_length=1, description="Where set, requests must carry it; health checks need none."
    )
    data_dir: Path = Field(
        default_factory=lambda: Path(platformdirs.user_data_dir("samplerscope")),
        description="Folder of stored results and jobs.",
    )
    store_limit_bytes: int = Field(1 << 30, gt=0, description="Stored results beyond this go, least used first.")
    store_max_age_s: Seconds = Field(30 * 86400.0, description="Results and finished jobs older than this go.")
    store_max_jobs: int = Field(1000, ge=0, le=10**9, description="Finished jobs beyond this go, oldest first.")
    max_body_bytes: int = Field(1 << 20, gt=0, description="Largest body of a request.")
    max_samples: int = Field(10**13, gt=0, description="Most samples of one question, in all its cells.")
    max_cells: int = Field(65536, gt=0, description="Most cells (series x angles) of one question.")
    direct_limit_s: SecondsFrom0 = Field(3.0, description="A question that is estimated to take longer becomes a job.")
    request_timeout_s: Seconds = Field(60.0, description="Longest a request may take to arrive, and its answer.")
    queue_limit: int = Field(64, ge=0, description="Most direct questions that may wait.")
    jobs_limit: int = Field(100, ge=0, description="Most jobs that may wait.")
    client_limit: int = Field(16, gt=0, description="Most computations that one client may have under way.")
    beat_timeout_s: Seconds = Field(2.0, description="A worker silent for longer is replaced.")
    stall_timeout_s: Seconds = Field(60.0, description="A worker whose task gets no further for longer is replaced.")
    own_glsl: bool = Field(False, description="Whether clients may send shader text, which runs confined.")
    own_glsl_limit_s: Seconds = Field(50.0, description="Longest that work on a client's shader text may take.")
    graceful_s: SecondsFrom0 = Field(10.0, description="How long requests may finish when the server stops.")
    log_level: str = Field("info", pattern="^(debug|info|warning|error)$", description="Least level that is logged.")


def load_settings(**given: object) -> Settings:
    """Settings of the environment, with values that were given in their place. BadInput names every wrong one."""
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})  # type: ignore[arg-type]
    except ValidationError as error:
        raise BadInput(
            [
                Problem(
                    "SAMPLERSCOPE_" + "_".join(map(str, item["loc"])).upper(),
                    item["input"],
                    "a text" if item["type"].endswith("too_short") else allowed_in_words(item["msg"]),
                )
                for item in error.errors(include_url=False)
            ]
        ) from None
