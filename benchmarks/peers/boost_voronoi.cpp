// The medial axis of a flattened domain by Boost.Polygon: the Voronoi diagram of its chords, less what lies outside and
// less the spokes that flattening made.
//
//   boost_voronoi CHORDS BUDGET_SECONDS MOST_RUNS [POLYLINES]
//
// CHORDS (see benchmarks/peers/chords.py): int64 number of loops; for each loop int64 number of vertices and as many rows of
// int32 x, y, corner. The interior lies on the left; corner tells that the boundary itself has a corner there.
//
// Timed, in CPU time of this process, is building the diagram and filtering it. One line of JSON is printed.

#include <boost/polygon/segment_data.hpp>
#include <boost/polygon/voronoi.hpp>
#include <boost/version.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

namespace polygon = boost::polygon;
using Diagram = polygon::voronoi_diagram<double>;
using Edge = Diagram::edge_type;
using Cell = Diagram::cell_type;
using Segment = polygon::segment_data<int32_t>;
using Point = polygon::point_data<int32_t>;

struct Boundary {
    std::vector<Segment> chords;    // interior on the left
    std::vector<uint8_t> corner;    // at the start of each chord: the boundary itself has a corner
    std::vector<uint8_t> reflex;    // at the start of each chord: it turns right
    std::vector<int32_t> next;      // chord after each chord, round its loop
};

static double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

static Boundary read(const char* path) {
    Boundary b;
    FILE* file = std::fopen(path, "rb");
    if (!file) { std::perror(path); std::exit(2); }
    auto number = [&] { int64_t n = 0; if (std::fread(&n, sizeof n, 1, file) != 1) std::exit(2); return n; };
    for (int64_t loops = number(); loops > 0; --loops) {
        const int64_t count = number(), first = int64_t(b.chords.size());
        std::vector<int32_t> row(size_t(3 * count));
        if (std::fread(row.data(), sizeof(int32_t), row.size(), file) != row.size()) std::exit(2);
        auto at = [&](int64_t i) { i = (i + count) % count; return Point(row[size_t(3 * i)], row[size_t(3 * i + 1)]); };
        for (int64_t i = 0; i < count; ++i) {
            const Point a = at(i - 1), p = at(i), c = at(i + 1);
            b.chords.emplace_back(p, c);
            b.corner.push_back(uint8_t(row[size_t(3 * i + 2)]));
            const __int128 turn = __int128(int64_t(p.x()) - a.x()) * (int64_t(c.y()) - p.y())
                                - __int128(int64_t(p.y()) - a.y()) * (int64_t(c.x()) - p.x());
            b.reflex.push_back(turn < 0);
            b.next.push_back(int32_t(first + (i + 1) % count));
        }
    }
    std::fclose(file);
    return b;
}

// The vertex of the boundary that a point cell belongs to, named by the chord that starts there.
static size_t vertex_of(const Boundary& b, const Cell& cell) {
    const size_t i = cell.source_index();
    return cell.source_category() == polygon::SOURCE_CATEGORY_SEGMENT_START_POINT ? i : size_t(b.next[i]);
}

// A point's cell lies inside when the boundary turns right there; an edge between two chords is on one side of either.
static bool inside(const Boundary& b, const Edge& e) {
    for (const Cell* cell : {e.cell(), e.twin()->cell()})
        if (cell->contains_point()) return b.reflex[vertex_of(b, *cell)];
    const Segment& s = b.chords[e.cell()->source_index()];
    const double x = s.low().x(), y = s.low().y(), dx = s.high().x() - x, dy = s.high().y() - y;
    double left = 0.0;
    for (const auto* v : {e.vertex0(), e.vertex1()}) left += dx * (v->y() - y) - dy * (v->x() - x);
    return left > 0.0;
}

// The bisector of two chords that meet where the boundary is smooth is no part of the axis.
static bool spoke(const Boundary& b, const Edge& e) {
    if (e.cell()->contains_point() || e.twin()->cell()->contains_point()) return false;
    const size_t i = e.cell()->source_index(), j = e.twin()->cell()->source_index();
    return (size_t(b.next[i]) == j && !b.corner[j]) || (size_t(b.next[j]) == i && !b.corner[i]);
}

static void kept_edges(const Boundary& b, const Diagram& diagram, std::vector<const Edge*>& kept) {
    kept.clear();
    for (const Edge& e : diagram.edges())
        if (&e < e.twin() && e.is_primary() && e.is_finite() && inside(b, e) && !spoke(b, e)) kept.push_back(&e);
}

// Points on the parabola between a point and a chord, evenly along the chord; its ends are given.
static void parabola(const Boundary& b, const Edge& e, int pieces, FILE* out) {
    const Cell* at = e.cell()->contains_point() ? e.cell() : e.twin()->cell();
    const Cell* along = e.cell()->contains_point() ? e.twin()->cell() : e.cell();
    const Point p = b.chords[vertex_of(b, *at)].low();
    const Segment& s = b.chords[along->source_index()];
    const double length = std::hypot(double(s.high().x()) - s.low().x(), double(s.high().y()) - s.low().y());
    const double tx = (double(s.high().x()) - s.low().x()) / length, ty = (double(s.high().y()) - s.low().y()) / length;
    auto across = [&](double x, double y) { return -ty * (x - s.low().x()) + tx * (y - s.low().y()); };
    auto travel = [&](double x, double y) { return tx * (x - s.low().x()) + ty * (y - s.low().y()); };
    const double focus_t = travel(p.x(), p.y()), focus_n = across(p.x(), p.y());
    const double t0 = travel(e.vertex0()->x(), e.vertex0()->y()), t1 = travel(e.vertex1()->x(), e.vertex1()->y());
    for (int i = 1; i < pieces; ++i) {
        const double t = t0 + (t1 - t0) * i / pieces;
        const double n = (focus_n * focus_n + (t - focus_t) * (t - focus_t)) / (2.0 * focus_n);
        const double xy[2] = {s.low().x() + t * tx - n * ty, s.low().y() + t * ty + n * tx};
        std::fwrite(xy, sizeof(double), 2, out);
    }
}

static void write(const Boundary& b, const std::vector<const Edge*>& kept, const char* path) {
    FILE* out = std::fopen(path, "wb");
    if (!out) { std::perror(path); std::exit(2); }
    const int pieces = kept.size() < 1000 ? 512 : kept.size() < 20000 ? 32 : 4;  // of a parabola: the fewer, the longer they are
    for (const Edge* e : kept) {
        const bool bent = e->is_curved() && e->cell()->contains_point() != e->twin()->cell()->contains_point();
        const double count = bent ? pieces + 1 : 2;
        const double first[3] = {count, e->vertex0()->x(), e->vertex0()->y()}, last[2] = {e->vertex1()->x(), e->vertex1()->y()};
        std::fwrite(first, sizeof(double), 3, out);
        if (bent) parabola(b, *e, pieces, out);
        std::fwrite(last, sizeof(double), 2, out);
    }
    std::fclose(out);
}

int main(int argc, char** argv) {
    if (argc == 2 && std::string(argv[1]) == "--version") { std::puts(BOOST_LIB_VERSION); return 0; }
    if (argc < 4) { std::fprintf(stderr, "boost_voronoi CHORDS BUDGET_SECONDS MOST_RUNS [POLYLINES]\n"); return 2; }
    const Boundary b = read(argv[1]);
    const double budget = std::atof(argv[2]);
    const int most = std::atoi(argv[3]);
    std::vector<double> spent;
    std::vector<const Edge*> kept;
    Diagram diagram;
    // the first run warms memory and is left out, unless it alone takes up the time
    for (double total = 0.0; int(spent.size()) < most + 1 && (spent.empty() || total < budget); total += spent.back()) {
        diagram.clear();
        const double begun = cpu_seconds();
        polygon::construct_voronoi(b.chords.begin(), b.chords.end(), &diagram);
        kept_edges(b, diagram, kept);
        spent.push_back(cpu_seconds() - begun);
    }
    if (spent.size() > 1) spent.erase(spent.begin());
    std::sort(spent.begin(), spent.end());
    std::printf("{\"ms\": %.6f, \"runs\": %zu, \"kept\": %zu, \"given\": %zu}\n",
                1e3 * 0.5 * (spent[spent.size() / 2] + spent[(spent.size() - 1) / 2]), spent.size(), kept.size(), b.chords.size());
    if (argc > 4) write(b, kept, argv[4]);
    return 0;
}
