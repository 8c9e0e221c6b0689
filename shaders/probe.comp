// Evaluates single inputs and keeps every intermediate value: for replays, edge cases and tests. Widened to double, it is
// the float64 truth of the same code.
layout(local_size_x = 64) in;

layout(constant_id = 0) const bool DRAW = true; // true: the input is (u1, u2), and wi is drawn; false: the input is wi

struct Input {
    vec4 view;   // wo
    vec4 value;  // u1, u2 or wi
};

struct Output {
    vec4 direction;  // wi, and the density that came with it (0 where wi was given)
    vec4 values;     // brdf, direction_pdf, weight, directional albedo (0 where the model has none)
};

layout(std430, set = 0, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, set = 0, binding = 1) readonly buffer Parameters { float parameter_values[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Outputs { Output outputs[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Done { uint done[]; };  // 1 where every loop ran to its end

layout(push_constant) uniform Launch { uint count; uint two; };

#include "common/loops.glsl"
#include "variant/load_parameters.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    load_parameters(i);
    vec3 wo = inputs[i].view.xyz;
    DirectionSample s = DirectionSample(inputs[i].value.xyz, 0.0);
    if (DRAW) s = technique_sample_direction(wo, inputs[i].value.xy);
    float pdf = technique_direction_pdf(wo, s.wi);
    float weight = throughput_weight(DRAW ? s : DirectionSample(s.wi, pdf), wo);
    outputs[i].direction = vec4(s.wi, s.pdf);
    outputs[i].values = vec4(model_brdf(s.wi, wo), pdf, weight, ALBEDO_OF_VIEW);
    done[i] = loops_ran(two) ? 1u : 0u;
}
