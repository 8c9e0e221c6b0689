"""Composing and compiling GLSL: every message leads to the caller's own file and line."""

import os
import time

import pytest

from lavapipe import Cache, CompileError, DeviceNotFound, InvalidArgument, compile_glsl, compiler, read_module

HEAD = "#version 450\nlayout(local_size_x = 1) in;\n"
MAIN = "void main() {}\n"


def errors(source: str, **options: object) -> list[tuple[str, int]]:
    with pytest.raises(CompileError) as caught:
        compile_glsl(source, cache=Cache.disabled(), **options)  # type: ignore[arg-type]
    return [(d.file, d.line) for d in caught.value.diagnostics]


def test_spirv_is_a_module() -> None:
    assert "main" in read_module(compile_glsl(HEAD + MAIN)).entry_points


def test_error_names_source_and_line() -> None:
    assert errors(HEAD + "void main() { nonsense; }\n", name="my shader:1.comp") == [("my shader:1.comp", 3)]


def test_error_text_is_file_line_message() -> None:
    with pytest.raises(CompileError, match=r"^a\.comp:3: 'nonsense' : undeclared identifier$"):
        compile_glsl(HEAD + "void main() { nonsense; }\n", name="a.comp")


def test_error_names_included_file_and_line() -> None:
    include = {"common/arc.glsl": "float f() { return 1.0; }\n\nfloat g() { return nonsense; }\n"}
    assert errors(HEAD + '#include "common/arc.glsl"\n' + MAIN, include=include) == [("common/arc.glsl", 3)]


def test_lines_after_an_include_are_the_sources_own() -> None:
    include = {"a": "int a;\nint b;\nint c;"}
    assert errors(HEAD + '#include "a"\nvoid main() {\n  nonsense; }\n', include=include) == [("shader.comp", 5)]


def test_line_directives_of_the_source_are_honoured() -> None:
    source = HEAD + '#line 100 "users own.glsl"\nint a;\nvoid main() { nonsense; }\n'
    assert errors(source) == [("users own.glsl", 101)]


def test_line_directive_holds_after_an_include() -> None:
    source = HEAD + '#line 100 "user.glsl"\n#include "a"\nvoid main() { nonsense; }\n'
    assert errors(source, include={"a": "int a;\n"}) == [("user.glsl", 101)]


def test_line_directive_inside_an_include_ends_with_it() -> None:
    source = HEAD + '#include "a"\nvoid main() { nonsense; }\n'
    assert errors(source, include={"a": '#line 7 "b"\nint a;\n'}) == [("shader.comp", 4)]


def test_comments_and_continuations_keep_lines() -> None:
    source = HEAD + "/* one\n two\n*/ int a; // three \\\n four\n#define X \\\n  1\nvoid main() {\n nonsense; }\n"
    assert errors(source) == [("shader.comp", 10)]


def test_linker_messages_have_no_line() -> None:
    assert errors("#version 450\n") == [("shader.comp", 0)]


def test_missing_version_is_460() -> None:
    assert compile_glsl("layout(local_size_x = __VERSION__ - 459) in;\n// #version 100\n" + MAIN)
    assert errors("int a;\nnonsense;\n")[0] == ("shader.comp", 2)


def test_defines_follow_version_and_keep_lines() -> None:
    source = "// head\n" + HEAD + "int a[N]; float f = F; bool b = B;\nvoid main() { WORD; nonsense; }\n"
    assert errors(source, defines={"N": 3, "F": 0.5, "B": True, "WORD": "int c = 1"})[0][1] == 4
    ok = HEAD + "shared int a[N];\nvoid main() { float f = F; f += W; a[0] = int(f); }\n"
    assert compile_glsl(ok, defines={"N": 3, "F": 1e-20, "W": "2.0"})


def test_error_in_a_define_names_it() -> None:
    assert errors(HEAD + MAIN, defines={"A": 1, "defined": 1}) == [("<define defined>", 1)]


@pytest.mark.parametrize(
    "defines", [{"a b": 1}, {"X": float("nan")}, {"X": "1\n#include"}, {"X": "1\\"}, {"": 1}, {"X(a)": 1}]
)
def test_bad_defines_are_refused(defines: dict[str, object]) -> None:
    with pytest.raises(InvalidArgument, match="defines"):
        compile_glsl(HEAD + MAIN, defines=defines)  # type: ignore[arg-type]


def test_unknown_include_names_where() -> None:
    include = {"a": '\n\n#include "b"\n'}
    assert errors(HEAD + '#include "a"\n' + MAIN, include=include) == [("a", 3)]


def test_include_cycle_is_an_error() -> None:
    assert errors(HEAD + '#include "a"\n' + MAIN, include={"a": '#include "b"', "b": '\n#include "a"'}) == [("b", 2)]


def test_include_bomb_is_an_error() -> None:
    include = {f"f{i}": f'#include "f{i + 1}"\n' * 8 for i in range(20)} | {"f20": "int a;\n" * 100}
    start = time.process_time()
    assert errors(HEAD + '#include "f0"\n' + MAIN, include=include)
    assert time.process_time() - start < 10


def test_guarded_include_may_come_twice() -> None:
    include = {"a": "#ifndef A\n#define A\nint f() { return 1; }\n#endif\n"}
    assert compile_glsl(HEAD + '#include "a"\n#include <a>\n' + MAIN, include=include)


def test_include_in_a_comment_is_text() -> None:
    assert compile_glsl(HEAD + '// #include "x"\n/*\n#include "x"\n*/\n' + MAIN)


ESCAPES = {
    "plain": '#include "{}"',
    "extension": '#extension GL_GOOGLE_include_directive : enable\n#include "{}"',
    "all extensions": '#extension all : warn\n#include "{}"',
    "comment in the directive": '#extension GL_GOOGLE_include_directive : enable\n# /* */ include "{}"',
    "continued word": '#exten\\\nsion GL_GOOGLE_include_directive : enable\n#inc\\\nlude "{}"',
    "continued name": '#extension GL_GOOGLE_include_\\\ndirective : enable\n#include "{}"',
    "after a comment": '/* */ #extension GL_GOOGLE_include_directive : enable\n/*\n*/#include "{}"',
    "carriage return": 'int a;\r#extension GL_GOOGLE_include_directive : enable\r#include "{}"',
    "stray quote": '#define A "/*\n#extension GL_GOOGLE_include_directive : enable\n#include "{}"\n/* */',
    "continued comment": '// \\\n#extension GL_GOOGLE_include_directive : enable\n// \\\n#include "{}"',
    "split comment": '/\\\n* \n#extension GL_GOOGLE_include_directive : enable\n#include "{}"\n*/',
    "macro": '#define I include\n#extension GL_GOOGLE_include_directive : enable\n#I "{}"',
}


@pytest.mark.parametrize("version", ["#version 450", "#version 310 es", "#version 430"])
@pytest.mark.parametrize("escape", ESCAPES.values(), ids=ESCAPES)
def test_no_source_reads_a_host_file(escape: str, version: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    secret = tmp_path_factory.getbasetemp() / "secret"
    secret.write_text("passphrase_1;\n")
    for path in (str(secret), "../" * 9 + str(secret)[1:], str(secret)[1:]):
        source = f"{version}\n{escape.format(path)}\nlayout(local_size_x = 1) in;\n" + MAIN
        said = ""
        try:
            compile_glsl(source, cache=Cache.disabled())
        except CompileError as error:
            said = str(error)
        assert "passphrase" not in said


def test_macro_bomb_is_an_error_within_limits() -> None:
    doubling = "#define A0 1.0+\n" + "".join(f"#define A{i + 1} A{i} A{i}\n" for i in range(40))
    before = os.times()
    assert errors(HEAD + doubling + "void main() { float f = A40 1.0; }\n", timeout_s=2)
    after = os.times()
    assert after.children_user + after.children_system - before.children_user - before.children_system < 6


def test_deep_expression_is_an_error() -> None:
    assert errors(HEAD + f"void main() {{ float x = 1.0; float f = {'x+' * 200_000} x; }}\n")


@pytest.mark.parametrize("source", ["\0", "/* open", '#include "', "#line x", "#extension :"])
def test_malformed_text_is_a_compile_error_at_its_line(source: str) -> None:
    assert errors(HEAD + source + "\n" + MAIN)[0][1] == 3


def test_missing_compiler_is_one_clear_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(DeviceNotFound, match=r"^glslangValidator is not installed: run lavapipe/install\.sh$"):
        compile_glsl(HEAD + MAIN, cache=Cache.disabled())


def test_what_is_in_the_cache_needs_no_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    spirv = compile_glsl(HEAD + MAIN)
    monkeypatch.setenv("PATH", "/nowhere")
    assert compile_glsl(HEAD + MAIN) == spirv


def test_another_compiler_compiles_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    compile_glsl(HEAD + MAIN)
    calls = []
    run = compiler._run
    monkeypatch.setattr(compiler, "_identity", lambda path: b"another")
    monkeypatch.setattr(compiler, "_run", lambda *arguments: calls.append(1) or run(*arguments))
    for _ in range(2):
        compile_glsl(HEAD + MAIN)
    assert len(calls) == 1
