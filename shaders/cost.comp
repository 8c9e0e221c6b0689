// The cost of one call as a renderer pays it: view, direction, random numbers and every parameter change from call to
// call, so that a compiler can hoist nothing out of the loop. A checksum keeps the results alive.
layout(local_size_x = 64) in;

// 0: only the inputs, the empty loop; 1: brdf; 2: sample_direction and the weight; 3: direction_pdf.
layout(constant_id = 0) const uint TASK = 0u;

layout(std430, set = 0, binding = 0) readonly buffer Ranges { vec2 ranges[]; }; // least value and width, one a parameter
layout(std430, set = 0, binding = 1) writeonly buffer Results { vec2 results[]; }; // checksum and calls, one a lane

layout(push_constant) uniform Launch {
    uint calls; // for each lane
    uint round;
};

#include "common/hemisphere.glsl"
#include "variant/draw_parameters.glsl"

float uniform_number(uint bits) {
    return float(int(bits >> 8u)) * 5.9604644775390625e-8;
}

void main() {
    uint lane = gl_GlobalInvocationID.x;
    float checksum = 0.0, done = 0.0;
    for (uint i = 0u; i < calls; i++) {
        uvec4 a = pcg4d(uvec4(i, lane, round, 1u));
        uvec4 b = pcg4d(uvec4(i, lane, round, 2u));
        vec3 wo = uniform_hemisphere(vec2(uniform_number(a.x), uniform_number(a.y))).wi;
        vec3 wi = uniform_hemisphere(vec2(uniform_number(a.z), uniform_number(a.w))).wi;
        vec2 u = vec2(uniform_number(b.x), uniform_number(b.y));
        float value = draw_parameters(b.zw, uvec2(i, lane));
        value += (wo.x + wo.y + wo.z) + (wi.x + wi.y + wi.z) + (u.x + u.y);
        if (TASK == 1u) value += model_brdf(wi, wo);
        if (TASK == 2u) {
            DirectionSample s = technique_sample_direction(wo, u);
            value += throughput_weight(s, wo) + (s.wi.x + s.wi.y + s.wi.z);
        }
        if (TASK == 3u) value += technique_direction_pdf(wo, wi);
        checksum += value;
        done += 1.0;
    }
    results[lane] = vec2(checksum, done);
}
