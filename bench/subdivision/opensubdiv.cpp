// OpenSubdiv's side of the subdivision bench: `opensubdiv CAGE.obj LEVEL RUNS OUT` prints a line of JSON with medians in seconds,
// and writes the points of the last level in f64 to OUT.
//
// refine: topology of all levels and positions of each, uniform, without what the last level needs for limits only.
// build, apply: a table of stencils of the last level from the cage, and one pass over it into a buffer that is there.
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuVertexBuffer.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

using namespace OpenSubdiv;

template <class T> struct Point {
    T x[3];
    void Clear() { x[0] = x[1] = x[2] = 0; }
    template <class W> void AddWithWeight(Point const &p, W w) {
        for (int k = 0; k < 3; ++k) x[k] += T(w) * p.x[k];
    }
};

struct Cage {
    std::vector<double> positions;
    std::vector<int> sizes, corners, creases, sharp_vertices, holes;
    std::vector<float> crease_sharpness, vertex_sharpness;
    Sdc::Options options;
    Sdc::SchemeType scheme = Sdc::SCHEME_CATMARK;
};

static Cage read(char const *path) {
    Cage cage;
    cage.options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    std::string name(path);
    name = name.substr(name.rfind('/') + 1);
    if (name.rfind("loop", 0) == 0) cage.scheme = Sdc::SCHEME_LOOP;
    if (name.rfind("bilinear", 0) == 0) cage.scheme = Sdc::SCHEME_BILINEAR;
    std::ifstream file(path);
    std::string line, word;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        words >> word;
        if (word == "v") {
            double x;
            for (int k = 0; k < 3 && words >> x; ++k) cage.positions.push_back(x);
        } else if (word == "f") {
            int n = 0;
            while (words >> word) cage.corners.push_back(std::atoi(word.c_str()) - 1), ++n;
            cage.sizes.push_back(n);
        } else if (word == "t") {
            std::string tag, counts;
            words >> tag >> counts;
            int n_ints = 0, n_floats = 0;
            std::sscanf(counts.c_str(), "%d/%d", &n_ints, &n_floats);
            std::vector<int> ints(n_ints);
            std::vector<float> floats(n_floats);
            for (int &i : ints) words >> i;
            for (float &x : floats) words >> x;
            if (tag == "crease") {
                cage.creases.insert(cage.creases.end(), ints.begin(), ints.end());
                cage.crease_sharpness.insert(cage.crease_sharpness.end(), n_ints / 2, floats[0]);
            } else if (tag == "corner") {
                cage.sharp_vertices.insert(cage.sharp_vertices.end(), ints.begin(), ints.end());
                cage.vertex_sharpness.insert(cage.vertex_sharpness.end(), n_ints, floats[0]);
            } else if (tag == "hole") {
                cage.holes.insert(cage.holes.end(), ints.begin(), ints.end());
            } else if (tag == "creasemethod") {
                words >> word;
                if (word == "chaikin") cage.options.SetCreasingMethod(Sdc::Options::CREASE_CHAIKIN);
            } else if (tag == "interpolateboundary") {
                // In these files 1 is edges and corners.
                cage.options.SetVtxBoundaryInterpolation(
                    ints[0] == 0   ? Sdc::Options::VTX_BOUNDARY_NONE
                    : ints[0] == 1 ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                   : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
            }
        }
    }
    return cage;
}

static std::unique_ptr<Far::TopologyRefiner> refined(Cage const &cage, int level) {
    typedef Far::TopologyDescriptor Descriptor;
    Descriptor of;
    of.numVertices = int(cage.positions.size() / 3);
    of.numFaces = int(cage.sizes.size());
    of.numVertsPerFace = cage.sizes.data();
    of.vertIndicesPerFace = cage.corners.data();
    of.numCreases = int(cage.crease_sharpness.size());
    of.creaseVertexIndexPairs = cage.creases.data();
    of.creaseWeights = cage.crease_sharpness.data();
    of.numCorners = int(cage.vertex_sharpness.size());
    of.cornerVertexIndices = cage.sharp_vertices.data();
    of.cornerWeights = cage.vertex_sharpness.data();
    of.numHoles = int(cage.holes.size());
    of.holeIndices = cage.holes.data();
    typedef Far::TopologyRefinerFactory<Descriptor> Factory;
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(of, Factory::Options(cage.scheme, cage.options)));
    Far::TopologyRefiner::UniformOptions options(level);
    refiner->RefineUniform(options);
    return refiner;
}

template <class T> static std::vector<Point<T>> positions(Cage const &cage, Far::TopologyRefiner const &refiner) {
    Far::PrimvarRefinerReal<T> primvar(refiner);
    std::vector<Point<T>> before(cage.positions.size() / 3), after;
    for (size_t i = 0; i < cage.positions.size(); ++i) before[i / 3].x[i % 3] = T(cage.positions[i]);
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        after.resize(refiner.GetLevel(level).GetNumVertices());
        primvar.Interpolate(level, before, after);
        before.swap(after);
    }
    return before;
}

static double median(int runs, std::function<void()> const &run) {
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) {
        auto start = std::chrono::steady_clock::now();
        run();
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

int main(int argc, char **argv) {
    if (argc != 5) return std::fprintf(stderr, "opensubdiv CAGE LEVEL RUNS OUT\n"), 1;
    Cage const cage = read(argv[1]);
    int const level = std::atoi(argv[2]), runs = std::atoi(argv[3]);
    std::unique_ptr<Far::TopologyRefiner> refiner;
    double const topology = median(runs, [&] { refiner.reset(), refiner = refined(cage, level); });
    double const single = median(runs, [&] { positions<float>(cage, *refiner); });
    std::vector<Point<double>> points;
    double const both = median(runs, [&] { points.clear(), points.shrink_to_fit(), points = positions<double>(cage, *refiner); });
    int const faces = refiner->GetLevel(level).GetNumFaces();
    std::ofstream(argv[4], std::ios::binary).write(reinterpret_cast<char *>(points.data()), points.size() * sizeof(points[0]));

    std::unique_ptr<Far::StencilTable const> table;
    Far::StencilTableFactory::Options options;
    options.generateIntermediateLevels = false;
    options.generateOffsets = true;
    // Building takes seconds: a third of the runs.
    double const build = median((runs + 2) / 3, [&] {
        table.reset(), refiner.reset();
        refiner = refined(cage, level);
        table.reset(Far::StencilTableFactory::Create(*refiner, options));
    });
    std::vector<float> in(cage.positions.begin(), cage.positions.end()), out(3 * size_t(table->GetNumStencils()));
    Osd::BufferDescriptor const layout(0, 3, 3);
    double const apply = median(2 * runs, [&] {
        Osd::CpuEvaluator::EvalStencils(
            in.data(), layout, out.data(), layout, &table->GetSizes()[0], &table->GetOffsets()[0],
            &table->GetControlIndices()[0], &table->GetWeights()[0], 0, table->GetNumStencils());
    });
    double off = 0;
    for (size_t i = 0; i < out.size(); ++i) off = std::max(off, std::abs(double(out[i]) - points[i / 3].x[i % 3]));
    size_t const bytes = table->GetControlIndices().size() * 8 + table->GetSizes().size() * 8;
    std::printf(
        "{\"faces\": %d, \"points\": %zu, \"topology\": %.6f, \"positions_f32\": %.6f, \"positions_f64\": %.6f, \"build\": %.6f, "
        "\"apply\": %.6f, \"stencils_off\": %.3e, \"stencil_bytes\": %zu}\n",
        faces, points.size(), topology, single, both, build, apply, off, bytes);
}
