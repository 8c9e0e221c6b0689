// Monte Carlo statistics of the throughput weight. A workgroup does one block: a fixed range of BLOCK_SAMPLES sample
// indices of one cell (model, parameters, technique, view). Each of its 64 lanes writes sums over its own samples, and
// the host adds them in double precision, in an order that does not depend on the launch.
layout(local_size_x = 64) in;

const uint LANES = 64u;
const uint BLOCK_SAMPLES = 16384u; // 256 a lane: float32 sums stay good to 1e-6, and loop counts far below any limit

layout(constant_id = 0) const uint MOMENTS = 4u;     // highest power of (weight - shift) that is summed, 0 to 4
layout(constant_id = 1) const bool WITH_MAX = true;
layout(constant_id = 2) const bool SCRAMBLED_SOBOL = false; // in place of random numbers; the key scrambles
layout(constant_id = 3) const bool WITH_ZEROS = true;
layout(constant_id = 4) const bool WITH_FIRST_BAD = true;
layout(constant_id = 5) const bool PREPARED_ONCE = false;   // for the view, rather than for each sample

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

// What a lane has found: sums of powers of (weight - shift), the largest weight, and counts of samples.
struct Tally {
    float s1, s2, s3, s4, largest;
    uint drawn, zero, nonfinite, negative, first_bad;
};

void prepare(vec3 wo) {
    prepare_model(wo);
    prepare_technique(wo);
}

// Draws sample `index` of the block at u and adds it; one beyond the end of the block is not `live` and adds nothing.
void add_sample(inout Tally t, vec2 u, uint index, bool live, vec3 wo, float shift) {
    if (!PREPARED_ONCE) prepare(wo);
    DirectionSample s = technique_sample_direction(wo, u);
    float weight = throughput_weight(s, wo);
    bool bad = live && is_nonfinite(weight + (s.pdf + (s.wi.x + s.wi.y + s.wi.z)));
    bool counted = live && !bad;
    t.drawn += live ? 1u : 0u;
    if (WITH_ZEROS) t.zero += live && weight == 0.0 ? 1u : 0u;
    t.negative += live && weight < 0.0 ? 1u : 0u;
    t.nonfinite += bad ? 1u : 0u;
    if (WITH_FIRST_BAD) t.first_bad = bad ? min(t.first_bad, index) : t.first_bad;
    float d = counted ? weight - shift : 0.0;
    float d2 = d * d;
    if (MOMENTS >= 1u) t.s1 += d;
    if (MOMENTS >= 2u) t.s2 += d2;
    if (MOMENTS >= 3u) t.s3 += d2 * d;
    if (MOMENTS >= 4u) t.s4 += d2 * d2;
    if (WITH_MAX) t.largest = counted ? max(t.largest, weight) : t.largest;
}

// (u1, u2) of samples 2 n and 2 n + 1 of the block.
vec4 sample_numbers(uint n, uint block, uvec2 key) {
    if (SCRAMBLED_SOBOL) {
        uint first = block * BLOCK_SAMPLES + 2u * n;
        return vec4(scrambled_sobol_pair(first, key), scrambled_sobol_pair(first + 1u, key));
    }
    return random_samples(uvec2(n, block), key);
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint block = first_block + gl_WorkGroupID.x;
    uint cell = first_cell + gl_WorkGroupID.y;
    vec3 wo = view_direction(cells[cell].view.xyz);
    float shift = cells[cell].view.w;
    uvec2 key = cells[cell].key.xy;
    load_parameters(cell);
    if (PREPARED_ONCE) prepare(wo);

    Tally t = Tally(0.0, 0.0, 0.0, 0.0, -3.402823466e38, 0u, 0u, 0u, 0u, 0xffffffffu);
    uint end = block == last_block ? last_samples : BLOCK_SAMPLES;
    for (uint n = lane; 2u * n < end; n += LANES) {
        vec4 u = sample_numbers(n, block, key);
        add_sample(t, u.xy, 2u * n, true, wo, shift);
        add_sample(t, u.zw, 2u * n + 1u, 2u * n + 1u < end, wo, shift);
    }

    uint blocks = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    uint at = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LANES + lane;
    uint stride = blocks * LANES;
    sums[at] = t.s1;
    sums[at + stride] = t.s2;
    sums[at + 2u * stride] = t.s3;
    sums[at + 3u * stride] = t.s4;
    sums[at + 4u * stride] = t.largest;
    counts[at] = loops_ran(min(gl_NumWorkGroups.x + 1u, 2u)) ? t.drawn : 0u;
    counts[at + stride] = t.zero;
    counts[at + 2u * stride] = t.nonfinite;
    counts[at + 3u * stride] = t.negative;
    counts[at + 4u * stride] = t.first_bad;
}
