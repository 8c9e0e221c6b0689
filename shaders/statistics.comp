// Monte Carlo statistics of the throughput weight. A workgroup does one block: a fixed range of BLOCK_SAMPLES sample
// indices of one cell (model, parameters, technique, view). Each of its 64 lanes writes sums over its own samples, and
// the host adds them in double precision, in an order that does not depend on the launch.
layout(local_size_x = 64) in;

const uint LANES = 64u;
const uint BLOCK_SAMPLES = 16384u; // 256 a lane: float32 sums stay good to 1e-6, and loop counts far below any limit

layout(constant_id = 0) const uint MOMENTS = 4u;     // highest power of (weight - shift) that is summed, 0 to 4
layout(constant_id = 1) const bool WITH_MAX = true;
layout(constant_id = 2) const bool SCRAMBLED_SOBOL = false; // in place of random numbers; the key scrambles

struct Cell {
    vec4 view;   // wo, and the shift about which powers are summed
    uvec4 key;   // of the random numbers, in x and y
};

layout(std430, set = 0, binding = 0) readonly buffer Cells { Cell cells[]; };
layout(std430, set = 0, binding = 1) readonly buffer Parameters { float parameter_values[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Sums { float sums[]; };     // [S1 S2 S3 S4 max] x block x lane
layout(std430, set = 0, binding = 3) writeonly buffer Counts { uint counts[]; };  // [drawn, zero, nonfinite, negative, first bad] x block x lane

layout(push_constant) uniform Launch {
    uint first_cell;
    uint first_block;
    uint last_block;    // of the whole cell; it holds last_samples samples, the others BLOCK_SAMPLES
    uint last_samples;
};

#include "common/sobol.glsl"
#include "variant/load_parameters.glsl"

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint block = first_block + gl_WorkGroupID.x;
    uint cell = first_cell + gl_WorkGroupID.y;
    vec3 wo = cells[cell].view.xyz;
    float shift = cells[cell].view.w;
    uvec2 key = cells[cell].key.xy;
    load_parameters(cell);

    float s1 = 0.0, s2 = 0.0, s3 = 0.0, s4 = 0.0, largest = -3.402823466e38;
    uint drawn = 0u, zero = 0u, nonfinite = 0u, negative = 0u, first_bad = 0xffffffffu;
    uint end = block == last_block ? last_samples : BLOCK_SAMPLES;
    for (uint i = lane; i < end; i += LANES) {
        vec2 u = SCRAMBLED_SOBOL ? scrambled_sobol_pair(block * BLOCK_SAMPLES + i, key) : random_pair(uvec2(i, block), key);
        DirectionSample s = technique_sample_direction(wo, u);
        float weight = throughput_weight(s, wo);
        bool bad = is_nonfinite(weight + (s.pdf + (s.wi.x + s.wi.y + s.wi.z)));
        drawn++;
        zero += weight == 0.0 ? 1u : 0u;
        negative += weight < 0.0 ? 1u : 0u;
        nonfinite += bad ? 1u : 0u;
        first_bad = bad ? min(first_bad, i) : first_bad;
        float d = bad ? 0.0 : weight - shift;
        if (MOMENTS >= 1u) s1 += d;
        if (MOMENTS >= 2u) s2 += d * d;
        if (MOMENTS >= 3u) s3 += d * d * d;
        if (MOMENTS >= 4u) s4 += (d * d) * (d * d);
        if (WITH_MAX) largest = bad ? largest : max(largest, weight);
    }

    uint blocks = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    uint at = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LANES + lane;
    uint stride = blocks * LANES;
    sums[at] = s1;
    sums[at + stride] = s2;
    sums[at + 2u * stride] = s3;
    sums[at + 3u * stride] = s4;
    sums[at + 4u * stride] = largest;
    counts[at] = loops_ran(min(gl_NumWorkGroups.x + 1u, 2u)) ? drawn : 0u;
    counts[at + stride] = zero;
    counts[at + 2u * stride] = nonfinite;
    counts[at + 3u * stride] = negative;
    counts[at + 4u * stride] = first_bad;
}
