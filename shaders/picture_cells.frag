// The mean of a picture's texels under each cell of a grid, which is what is drawn to.

uniform sampler2D picture;
uniform vec2 cells;   // columns, rows
uniform int maxTexels;  // texels along an axis that are read for a cell

layout(location = 0) out vec4 mean;

void main() {
    ivec2 size = textureSize(picture, 0), grid = ivec2(cells), cell = ivec2(gl_FragCoord.xy);
    ivec2 begin = cell * size / grid, end = max((cell + 1) * size / grid, begin + 1);
    ivec2 count = min(end - begin, ivec2(maxTexels));
    vec4 sum = vec4(0.0);
    for (int y = 0; y < count.y; ++y)
        for (int x = 0; x < count.x; ++x)
            sum += texelFetch(picture, begin + (2 * ivec2(x, y) + 1) * (end - begin) / (2 * count), 0);
    mean = sum / float(count.x * count.y);
}
