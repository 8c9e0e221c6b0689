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
layout(constant_id = 5) const bool FORMED_ONCE = false;     // what depends on the view alone, not for every sample

struct Cell {
    vec4 view;   // wo, and the shift about which powers are summed
    uvec4 key;   // of the random numbers, in x and y
};

layout(std430, set = 0, binding = 0) readonly buffer Cells { Cell cells[]; };
layout(std430, set = 0, binding = 1) readonly buffer Parameters { float parameter_values[]; };
// By lane and then by block: sums of the powers 1 to 4; and the largest weight, counts of zero and of negative weights in
// 16 bits each, the first index that is not finite, counts of samples drawn and of those not finite in 16 bits each.
layout(std430, set = 0, binding = 2) writeonly buffer Powers { vec4 powers[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Found { uvec4 found[]; };

layout(push_constant) uniform Launch {
    uint first_cell;
    uint first_block;
    uint last_block;    // of the whole cell; it holds last_samples samples, the others BLOCK_SAMPLES
    uint last_samples;
};

#include "common/sobol.glsl"
#include "variant/load_parameters.glsl"

// What a lane has found: sums of powers of (weight - shift), the largest weight, counts of samples and the index of the
// first that is not finite.
struct Tally {
    float s1, s2, s3, s4, largest;
    uint not_positive; // samples of weight 0, and 65536 times those of negative weight
    uint nonfinite, first_bad;
};

const Tally NOTHING = Tally(0.0, 0.0, 0.0, 0.0, -3.402823466e38, 0u, 0u, 0xffffffffu);

// Adds sample `index` of the block.
void add_sample(inout Tally t, DirectionSample s, float weight, uint index, float shift) {
    bool bad = is_nonfinite(weight + (s.pdf + (s.wi.x + s.wi.y + s.wi.z)));
    if (WITH_ZEROS) t.not_positive += weight == 0.0 ? 1u : 0u;
    t.not_positive += weight < 0.0 ? 65536u : 0u;
    t.nonfinite += bad ? 1u : 0u;
    if (WITH_FIRST_BAD) t.first_bad = bad ? min(t.first_bad, index) : t.first_bad;
    float d = bad ? 0.0 : weight - shift;
    float d2 = d * d;
    if (MOMENTS >= 1u) t.s1 += d;
    if (MOMENTS >= 2u) t.s2 += d2;
    if (MOMENTS >= 3u) t.s3 += d2 * d;
    if (MOMENTS >= 4u) t.s4 += d2 * d2;
    if (WITH_MAX) t.largest = !bad && weight > t.largest ? weight : t.largest;
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

    uint samples = block == last_block ? last_samples : BLOCK_SAMPLES;
    uint fours = samples / 4u, rest = samples % 4u;

    // Up to three samples are left over: lanes 0 to 2 add one each. Every lane draws one, before the loop: what depends on
    // the view alone is then known there, and the driver, which moves nothing out of a loop, forms it once.
    vec4 v = sample_numbers(2u * fours + lane / 2u, block, key);
    DirectionSample left = technique_sample_direction(wo, (lane & 1u) == 0u ? v.xy : v.zw);
    Tally with_left = NOTHING;
    add_sample(with_left, left, throughput_weight(left, wo), 4u * fours + lane, shift);
    Tally t = NOTHING;
    if (lane < rest) t = with_left;

    if (!FORMED_ONCE) { // the compiler does not know that the number of a group along z is 0, and so that nothing changes
        wo = view_direction(cells[cell + gl_WorkGroupID.z].view.xyz);
        load_parameters(cell + gl_WorkGroupID.z);
    }

    // Four samples at a time, stage by stage: a processor looks some 200 instructions ahead, and so works at all of them
    // while one would wait for its own results.
    uint n = lane;
    for (; n < fours; n += LANES) {
        vec4 u = sample_numbers(2u * n, block, key), v = sample_numbers(2u * n + 1u, block, key);
        DirectionSample a = technique_sample_direction(wo, u.xy), b = technique_sample_direction(wo, u.zw);
        DirectionSample c = technique_sample_direction(wo, v.xy), d = technique_sample_direction(wo, v.zw);
        float weight_a = throughput_weight(a, wo), weight_b = throughput_weight(b, wo);
        float weight_c = throughput_weight(c, wo), weight_d = throughput_weight(d, wo);
        add_sample(t, a, weight_a, 4u * n, shift);
        add_sample(t, b, weight_b, 4u * n + 1u, shift);
        add_sample(t, c, weight_c, 4u * n + 2u, shift);
        add_sample(t, d, weight_d, 4u * n + 3u, shift);
    }

    // Fewer than asked where the driver ended a loop.
    uint drawn = loops_ran(min(gl_NumWorkGroups.x + 1u, 2u)) ? (n - lane) / LANES * 4u + (lane < rest ? 1u : 0u) : 0u;
    uint blocks = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    uint at = lane * blocks + gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    powers[at] = vec4(t.s1, t.s2, t.s3, t.s4);
    found[at] = uvec4(floatBitsToUint(t.largest), t.not_positive, t.first_bad, drawn | t.nonfinite << 16u);
}
