/*---
provides = ["model"]
name = "printed-eon"
title = "EON with its formulas evaluated as they are printed"
source = "Portsmouth, Kutz, Hill 2024 (EON), eq. 10 to 19; for comparison with the stable forms of shaders/common/fon.glsl"
[parameters.roughness]
min = 0.0
max = 1.0
default = 1.0
[parameters.albedo]
min = 0.0
max = 1.0
default = 1.0
---*/

const float C1 = 0.5 - 2.0 / (3.0 * PI);
const float C2 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

float fon_albedo(float mu) {
    float amplitude = 1.0 / (1.0 + C1 * roughness);
    float sine = sqrt(1.0 - mu * mu);
    float shape = sine * (acos(mu) - sine * mu) + (2.0 / 3.0) * ((sine / mu) * (1.0 - sine * sine * sine) - sine);
    return amplitude * (1.0 + roughness * shape / PI);
}

float average_albedo() {
    return (1.0 + C2 * roughness) / (1.0 + C1 * roughness);
}

float multiple_albedo() {
    return albedo * albedo * average_albedo() / (1.0 - albedo * (1.0 - average_albedo()));
}

float brdf(vec3 wi, vec3 wo) {
    float s = dot(wi, wo) - wi.z * wo.z;
    float s_over_t = s > 0.0 ? s / max(wi.z, wo.z) : s;
    float single = albedo / PI * (1.0 + roughness * s_over_t) / (1.0 + C1 * roughness);
    float missing = (1.0 - fon_albedo(wo.z)) * (1.0 - fon_albedo(wi.z)) / (1.0 - average_albedo());
    return min(wi.z, wo.z) > 0.0 ? single + multiple_albedo() / PI * missing : 0.0;
}

float directional_albedo(float mu) {
    return albedo * fon_albedo(mu) + multiple_albedo() * (1.0 - fon_albedo(mu));
}
