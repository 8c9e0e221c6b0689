"""Entry point of the container: caches baked into the image are laid out where they can be written.

The root of a container may be read-only and its cache folder an empty tmpfs; the driver ignores a cache that it cannot
write. Copying a few megabytes at the start saves the compilation of every shader.
"""

from __future__ import annotations

import os
import shutil
import sys
import urllib.request
from http import HTTPStatus
from pathlib import Path
from typing import get_args

CACHES = ("SAMPLERSCOPE_CACHE_DIR", "MESA_SHADER_CACHE_DIR")


def main() -> None:
    """The command line, and two words of the image's own.

    `warm` fills the caches when the image is built (`warm everything` where the image has no GLSL compiler), `healthy`
    is its health check.
    """
    match sys.argv[1:]:
        case ["warm", *scope]:
            warm(everything="everything" in scope)
        case ["healthy"]:
            sys.exit(0 if healthy(int(os.environ["SAMPLERSCOPE_PORT"])) else 1)
        case _:
            run()


def run() -> None:
    """Seed the caches from the image's own, and do what the arguments say."""
    baked = os.environ.get("SAMPLERSCOPE_WARM_CACHE")
    if baked:
        seed(Path(baked))

    from service.cli import main as command_line

    command_line()


def seed(baked: Path) -> None:
    """Copy the baked caches to the folders that the environment names, where those do not exist yet."""
    for variable in CACHES:
        folder = Path(os.environ[variable])
        source = baked / folder.name
        if source.is_dir() and not folder.exists():
            try:
                shutil.copytree(source, folder, copy_function=shutil.copyfile)
            except OSError as error:  # without a writable folder everything works, only slower
                sys.stderr.write(f"samplerscope: starting with cold caches: {error.strerror}\n")


def warm(*, everything: bool) -> None:
    """Compile the statistics of every model with every technique made for it; with `everything`, all other jobs too."""
    from service.catalogue import load_catalogue
    from service.engine import Engine, Job
    from service.explain.shaders import whole_shader
    from service.scene import parse_scene, resolve
    from service.statistics import compute_statistics

    catalogue = load_catalogue()
    with Engine.open(catalogue) as engine:
        for model in catalogue.models.values():
            scene = {"model": model.name, "theta_o_deg": [0], "estimator": {"samples": 1}, "reference": False}
            within = {name: (one.min + one.max) / 2 for name, one in model.head.parameters.items()}
            for parameters in ({}, within):  # defaults are ends of ranges, where parts of a shader drop out
                question = resolve(parse_scene(scene | {"parameters": parameters}), catalogue)
                compute_statistics(question, engine)
            if everything:
                whole_shader(engine, question, question.series[0])
            for technique in map(catalogue.technique, catalogue.techniques_for(model.name) if everything else ()):
                for job in get_args(Job):
                    engine.pipeline(model, technique, job)
                engine.pipeline(model, technique, "probe", precision="double")


def healthy(port: int) -> bool:
    """Whether the service on this port of the loopback interface says that it is ready."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=8) as reply:
            return bool(reply.status == HTTPStatus.OK)
    except OSError:
        return False


if __name__ == "__main__":
    main()
