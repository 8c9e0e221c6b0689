"""Devices, buffers and pipelines: what goes in comes out, what cannot work is refused, nothing is left behind."""

import gc
import struct
from collections.abc import Iterator

import kernels
import numpy as np
import pytest

from lavapipe import (
    Buffer,
    Device,
    DriverError,
    InvalidArgument,
    LavapipeError,
    OutOfMemory,
    Pipeline,
    ValidationFailed,
    compile_glsl,
)
from lavapipe import _binding as vk


@pytest.fixture
def scale(device: Device) -> Iterator[Pipeline]:
    with device.pipeline(compile_glsl(kernels.SCALE), buffers=2, push_constant_bytes=8, name="scale") as pipeline:
        yield pipeline


def run_scale(device: Device, specialization: dict[int, int | float | bool], add: float = 0.0) -> np.ndarray:
    spirv = compile_glsl(kernels.SCALE)
    with (
        device.buffer(100, np.float32) as a,
        device.buffer(100, np.float32) as b,
        device.pipeline(spirv, buffers=2, push_constant_bytes=8, specialization=specialization) as pipeline,
    ):
        a.array[:] = np.arange(100)
        device.run(pipeline, [a, b], (2, 1, 1), struct.pack("If", 90, add))
        return b.array.copy()


def test_info_describes_lavapipe(device: Device) -> None:
    info = device.info
    assert info.is_lavapipe
    assert info.name.startswith("llvmpipe")
    assert info.driver_version.startswith("Mesa ")
    assert info.threads >= 1
    assert info.max_groups == (65535, 65535, 65535)
    assert info.api_version.startswith("1.")


@pytest.mark.parametrize("name", ["lavapipe", "LLVMPIPE", "llvmpipe (LLVM"])
def test_device_is_found_by_name(name: str) -> None:
    with Device.open(name, validation=True) as device:
        assert device.info.is_lavapipe


@pytest.mark.parametrize("dtype", ["f4", "f8", "u4", "i8", "u1", [("a", "f4"), ("b", "u4")]])
def test_buffers_are_zeroed_arrays_of_their_shape(device: Device, dtype: object) -> None:
    with device.buffer((3, 5), dtype) as buffer:  # type: ignore[arg-type]
        assert buffer.array.shape == (3, 5)
        assert buffer.array.dtype == np.dtype(dtype)  # type: ignore[call-overload]
        assert buffer.nbytes == buffer.array.nbytes
        assert not buffer.array.tobytes().strip(b"\0")
        buffer.array.view("u1")[...] = 7
        assert (buffer.array.view("u1") == 7).all()


def test_shader_sees_what_the_host_wrote_and_back(device: Device) -> None:
    expected = np.where(np.arange(100) < 90, np.arange(100) + 0.5, 0)
    np.testing.assert_array_equal(run_scale(device, {}, add=0.5), expected)


def test_specialization_reaches_the_shader_in_its_own_type(device: Device) -> None:
    result = run_scale(device, {3: 2, 4: -3, 5: 4_000_000_000, 6: True, 7: 0.125})
    expected = np.float32(np.arange(100) * 2.0) + np.float32(-3) + np.float32(4e9) + np.float32(0.25 + 0.125)
    np.testing.assert_allclose(result[:90], expected[:90], rtol=1e-6)
    np.testing.assert_array_equal(run_scale(device, {6: True, 7: 0.125})[:90], np.arange(90) + 0.375)


@pytest.mark.parametrize("value", [{9: 1}, {4: 1 << 31}, {5: -1}, {4: 0.5}, {6: 2}, {3: 1e39}, {4: "x"}])
def test_bad_specialization_is_named(device: Device, value: dict[int, float]) -> None:
    with pytest.raises(InvalidArgument, match=f"specialization=.{next(iter(value))}: "):
        device.pipeline(compile_glsl(kernels.SCALE), buffers=2, push_constant_bytes=8, specialization=value)


@pytest.mark.parametrize("shape", [0, -1, (3, 0), (2.5,), ()])
def test_bad_shapes_are_refused(device: Device, shape: object) -> None:
    if shape == ():
        with device.buffer((), np.float32) as buffer:
            assert buffer.array.shape == ()
        return
    with pytest.raises(InvalidArgument, match="shape"):
        device.buffer(shape, np.float32)  # type: ignore[arg-type]


def test_bad_dtypes_and_sizes_are_refused(device: Device) -> None:
    for dtype in (object, "nonsense", "V0"):
        with pytest.raises(InvalidArgument, match="dtype"):
            device.buffer(3, dtype)
    with pytest.raises(InvalidArgument, match="134,217,728"):
        device.buffer(1 << 28, np.float32)


def test_memory_limit_names_request_and_limit() -> None:
    with Device.open(validation=True, memory_limit_bytes=1 << 20) as device:
        first = device.buffer(700_000, np.uint8)
        with pytest.raises(OutOfMemory, match=r"400,000 bytes .* limit of 1,048,576 bytes") as caught:
            device.buffer(400_000, np.uint8)
        assert isinstance(caught.value, MemoryError)
        view = first.array[5:]
        first.close()
        with pytest.raises(OutOfMemory):
            device.buffer(400_000, np.uint8)
        del view
        device.buffer(400_000, np.uint8)


def test_closed_things_refuse_work(device: Device, scale: Pipeline) -> None:
    a, b = device.buffer(4, "f4"), device.buffer(4, "f4")
    b.close()
    with pytest.raises(InvalidArgument, match="this buffer is closed"):
        _ = b.array
    with pytest.raises(InvalidArgument, match="this buffer is closed"):
        device.run(scale, [a, b], (1, 1, 1), bytes(8))
    commands = device.record()
    commands.dispatch(scale, [a, a], (1, 1, 1), bytes(8))
    a.close()
    with pytest.raises(InvalidArgument, match="this buffer is closed"):
        commands.submit()
    scale.close()
    with pytest.raises(InvalidArgument, match="this pipeline 'scale' is closed"):
        device.record().dispatch(scale, [a, a], (1, 1, 1), bytes(8))


def test_bad_dispatches_are_named(device: Device, scale: Pipeline) -> None:
    with device.buffer(4, "f4") as a, Device.open() as other, other.buffer(4, "f4") as foreign:
        commands = device.record()
        cases: list[tuple[list[Buffer], tuple[int, ...], bytes, str]] = [
            ([a], (1, 1, 1), bytes(8), "buffers: 1 given, the pipeline has 2"),
            ([a, a], (0, 1, 1), bytes(8), "groups="),
            ([a, a], (1, 65536, 1), bytes(8), "groups=.*65535"),
            ([a, a], (1, 1), bytes(8), "groups="),
            ([a, a], (1.5, 1, 1), bytes(8), "groups="),  # type: ignore[list-item]
            ([a, a], (1, 1, 1), bytes(4), "push_constants: 4 bytes given, the pipeline has 8"),
            ([a, foreign], (1, 1, 1), bytes(8), "belongs to another device"),
        ]
        for buffers, groups, constants, message in cases:
            with pytest.raises(InvalidArgument, match=message):
                commands.dispatch(scale, buffers, groups, constants)  # type: ignore[arg-type]
        with pytest.raises(InvalidArgument, match="nothing to submit"):
            commands.submit()


def test_bad_pipelines_are_named(device: Device) -> None:
    spirv = compile_glsl(kernels.SCALE)
    cases: list[tuple[bytes, int, int, str]] = [
        (spirv, 1, 8, "set 0 binding 1"),
        (spirv, 2, 4, "block has 8 bytes"),
        (spirv, 2, 132, "from 0 to 128"),
        (spirv, 2, 10, "multiple of 4"),
        (spirv, -1, 8, "buffers=-1"),
        (b"", 2, 8, "no SPIR-V"),
        (bytes(400), 2, 8, "starts with 0x00000000"),
        (spirv[:-3], 2, 8, "no SPIR-V"),
        (spirv[:20] + bytes(400), 2, 8, "damaged at word 5"),
        (spirv[:20], 2, 8, "entry point"),
    ]
    for code, buffers, push_constants, message in cases:
        with pytest.raises(InvalidArgument, match=message):
            device.pipeline(code, buffers=buffers, push_constant_bytes=push_constants)


@pytest.mark.parametrize(
    ("declaration", "message"),
    [
        ("layout(set = 1, binding = 0) buffer B { float b[]; };", "set 1 binding 0"),
        ("layout(set = 0, binding = 0) uniform B { float b[4]; };", "only single storage buffers"),
        ("layout(set = 0, binding = 0) buffer B { float x; } b[2];", "only single storage buffers"),
        ("layout(set = 0, binding = 0, r32f) uniform image2D image;", "only single storage buffers"),
        (
            "#extension GL_EXT_buffer_reference : enable\nlayout(buffer_reference) buffer R { float b[]; };\n"
            "layout(push_constant) uniform P { R reference; };",
            "buffer references",
        ),
    ],
)
def test_shaders_that_reach_beyond_their_buffers_are_refused(device: Device, declaration: str, message: str) -> None:
    use = "imageStore(image, ivec2(0), vec4(0));" if "image" in declaration else "float x = b[0];"
    if "b[2]" in declaration:
        use = "b[1].x = 1.0;"
    if "reference" in declaration:
        use = "reference.b[0] = 1.0;"
    spirv = compile_glsl(f"#version 450\n{declaration}\nlayout(local_size_x = 1) in;\nvoid main() {{ {use} }}\n")
    with pytest.raises(InvalidArgument, match=message):
        device.pipeline(spirv, buffers=1, push_constant_bytes=8)


def test_300_pipelines_are_created(device: Device) -> None:
    spirv = compile_glsl(kernels.EMPTY)
    for _ in range(300):
        device.pipeline(spirv, buffers=0).close()


def test_nothing_leaks_over_200_runs(device: Device) -> None:
    before, used = device.live_objects, device.budget.used
    spirv = compile_glsl(kernels.STEP)
    for _ in range(200):
        with device.buffer(64, "u4") as buffer, device.pipeline(spirv, buffers=1) as pipeline:
            device.run(pipeline, [buffer], (1, 1, 1))
    gc.collect()
    assert (device.live_objects, device.budget.used) == (before, used)


def test_device_closes_what_is_open_and_twice_is_fine() -> None:
    with Device.open(validation=True) as device:
        buffer = device.buffer(64, "u4")
        pipeline = device.pipeline(compile_glsl(kernels.STEP), buffers=1)
        commands = device.record()
        commands.dispatch(pipeline, [buffer], (1, 1, 1))
        commands.submit()
        buffer.close()
        buffer.close()
    device.close()
    assert buffer.closed
    assert pipeline.closed
    assert device.live_objects == 0
    for use in (lambda: device.buffer(1, "f4"), device.record, device.__enter__):
        with pytest.raises(InvalidArgument, match="this device is closed"):
            use()


def test_array_outlives_buffer_and_device() -> None:
    with Device.open(validation=True) as device:
        array = device.buffer(1000, "u4").array
        array[:] = 5
    assert array.sum() == 5000
    array[:] = 6
    part = array[10:20].reshape(2, 5)
    del array
    assert part.sum() == 60


def test_devices_do_not_mind_each_other(device: Device) -> None:
    with Device.open(validation=True) as other, other.buffer(3, "f4") as buffer:
        buffer.array[:] = 1
    assert run_scale(device, {})[1] == 1


def test_a_misuse_of_vulkan_is_a_validation_failure() -> None:
    with Device.open(validation=True) as device, device.buffer(4, "f4") as buffer:
        pipeline = device.pipeline(compile_glsl(kernels.SCALE), buffers=2, push_constant_bytes=8)
        pipeline.push_constant_bytes = 16
        with pytest.raises(ValidationFailed, match="vkCmdPushConstants") as caught:
            device.run(pipeline, [buffer, buffer], (1, 1, 1), bytes(16))
        assert caught.value.messages


def test_an_object_left_behind_is_a_validation_failure() -> None:
    device = Device.open(validation=True)
    arena = vk.Arena()
    vk.create("VkFence", "vkCreateFence", device.logical.handle, arena.struct("VkFenceCreateInfo"), vk.ffi.NULL)
    with pytest.raises(ValidationFailed, match="VkFence"):
        device.close()


def test_validation_failure_at_close_does_not_hide_the_error() -> None:
    def leave() -> None:
        with Device.open(validation=True) as device:
            info = vk.Arena().struct("VkFenceCreateInfo")
            vk.create("VkFence", "vkCreateFence", device.logical.handle, info, vk.ffi.NULL)
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine") as caught:
        leave()
    assert "VkFence" in caught.value.__notes__[0]


def test_errors_are_one_tree() -> None:
    assert issubclass(OutOfMemory, LavapipeError)
    with pytest.raises(DriverError, match=r"^vkX: VK_ERROR_DEVICE_LOST\nsaid$"):
        vk.check(-4, "vkX", ["said"])
    with pytest.raises(OutOfMemory, match="vkX: VK_ERROR_OUT_OF_DEVICE_MEMORY"):
        vk.check(-2, "vkX")
    assert vk.result_name(-12345) == "VkResult -12345"
