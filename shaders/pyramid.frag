// Pass 2: a level of the pyramid, each texel the sum of its four children. Charts own whole 8x8 tiles, so
// levels 0 to 3 never mix two of them. source: Hensley et al. 2003, section 6.1.

uniform sampler2DArray finerLobe;        // BASE_LEVEL = the finer level
uniform sampler2DArray finerStatistics;
uniform int lobeIndex;

layout(location = 0) out vec4 lobe;
layout(location = 1) out vec2 lobeStatistics;

void main() {
    ivec3 child = ivec3(2 * ivec2(gl_FragCoord.xy), lobeIndex);
    lobe = texelFetch(finerLobe, child, 0) + texelFetch(finerLobe, child + ivec3(1, 0, 0), 0) +
           texelFetch(finerLobe, child + ivec3(0, 1, 0), 0) + texelFetch(finerLobe, child + ivec3(1, 1, 0), 0);
    lobeStatistics = texelFetch(finerStatistics, child, 0).rg +
                     texelFetch(finerStatistics, child + ivec3(1, 0, 0), 0).rg +
                     texelFetch(finerStatistics, child + ivec3(0, 1, 0), 0).rg +
                     texelFetch(finerStatistics, child + ivec3(1, 1, 0), 0).rg;
}
