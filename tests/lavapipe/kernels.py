"""Small compute shaders that the tests of this folder share."""

SCALE = """#version 450
layout(local_size_x = 64) in;
layout(constant_id = 3) const float scale = 1.0;
layout(constant_id = 4) const int whole = 0;
layout(constant_id = 5) const uint natural = 0u;
layout(constant_id = 6) const bool flag = false;
layout(constant_id = 7) const double wide = 0.0lf;
layout(push_constant) uniform Push { uint n; float add; };
layout(set = 0, binding = 0) readonly buffer A { float a[]; };
layout(set = 0, binding = 1) buffer B { float b[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < n) b[i] = a[i] * scale + add + float(whole) + float(natural) + (flag ? 0.25 : 0.0) + float(wide);
}
"""

# Depends on the order: x -> 3 x + 1, which a dispatch that runs too early or twice would spoil.
STEP = """#version 450
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) buffer A { uint a[]; };
void main() { uint i = gl_GlobalInvocationID.x; a[i] = a[(i + 1) % a.length()] * 0u + a[i] * 3u + 1u; }
"""

# Counts the iterations of one loop.
COUNT = """#version 450
layout(local_size_x = 1) in;
layout(push_constant) uniform Push { uint n; };
layout(set = 0, binding = 0) buffer A { uint count; };
void main() {
    uint c = 0;
    for (uint i = 0; i < n; ++i) c += (i | 1u) != 0u ? 1u : 0u;
    count = c;
}
"""

# Some 5 ms a workgroup.
SLOW = """#version 450
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) buffer A { float a[]; };
void main() {
    float x = float(gl_GlobalInvocationID.x);
    for (int i = 0; i < 20000; ++i) x = sin(x) + 0.5;
    a[gl_LocalInvocationID.x] = x;
}
"""

EMPTY = """#version 450
layout(local_size_x = 1) in;
void main() {}
"""
