// The lesson in English.
// Long because the texts of one language stand in one file, in the order of the page.
import { STOPS as BUDGETS } from "../exhibits/adaptive";
import { STOPS as DISTANCES, metres } from "../exhibits/levels";
import { STOPS as SIDES } from "../exhibits/overshade";
import type { LessonText } from "./lesson";
import { Formula, Handle, Set, Term } from "./parts";

export const EN: LessonText = {
  title: "How do you write a shape down? · Chordal",
  description:
    "One page on triangles, curves, fields and their cost, from a teapot’s first control point to its last triangle. Guess first, then move it: every number is computed in front of you.",
  words: {
    skip: "Skip to the figure",
    sections: "The five moves",
    elsewhere: "More of Chordal",
    onward: "Where to go from here",
    exhibits: "Exhibits",
    bench: "Workbench",
    workbench: "The workbench: your own shapes",
    widget: "The widget: how many segments until it looks smooth?",
    begin: "Begin the lesson: half an hour",
    distance: "How far away",
    seenFrom: (distance, pixels) => `What you see from ${distance}: ${pixels} pixels wide`,
    upClose: "The same triangles, held up close",
    enough: (pixels) => `triangles are enough: at most ${pixels} px off, proved`,
    spokenAt: (distance, triangles) => `${distance}, ${triangles} triangles`,
    all: (triangles) => `compare with ${triangles}`,
    heroPicture: "A teapot twice: as it is seen from afar, and the triangles that this takes, enlarged",
    asPoints: "A list: eight points, each joined to the next",
    asRule: "A rule: negative is inside",
    again: "Play again",
    ownPage: "This figure on its own page, with more to try",
    guess: "Guess first.",
    yourGuess: "Your guess",
    reveal: "Show me",
    showAnswer: "The answer",
    close: "You said {guess}. Close.",
    far: "You said {guess}. Look:",
    right: "Yes: {guess}.",
    wrong: "You said: {guess}. Look:",
    code: "Code",
    copy: "Copy",
    copied: "Copied",
    terms: "The words",
    termsLead: "Every term of the lesson, with its formula where it has one.",
    showTerms: "Show all terms",
    showTable: "Show the table",
    backToText: "Back to the text",
    closeTerm: "Close",
    turn: "Turn the card",
    answerOf: "An answer",
    yourAnswer: "In your own words",
    seeFigure: "See it move",
    footer:
      "Every number here is computed by Chordal’s core, the same code as in the command and the library. Nothing is sent anywhere. Without JavaScript the pictures stand still and everything can be read.",
  },
  hero: {
    question: "How many triangles does a teapot need?",
    sentence: (facts, say) => (
      <>
        {say.whole(facts.hero[0]!.triangles)} on the desk in front of you, {say.whole(facts.rest)} across the yard, and you cannot tell the
        difference. This page shows why, with one teapot from its first control point to its last pixel.
      </>
    ),
  },
  sections: {
    question: { kicker: "The question", title: "How do you write a shape down?" },
    atom: { kicker: "First move", title: "The triangle is the atom" },
    mesh: { kicker: "Second move", title: "The mesh stores millions" },
    smooth: { kicker: "Third move", title: "Authored smooth" },
    field: { kicker: "Fourth move", title: "The other answer: f(x) = 0" },
    cost: { kicker: "Fifth move", title: "The cost" },
  },
  blocks: (facts, say) => ({
    two: {
      title: "Two rival answers",
      text: (
        <>
          <p>
            You can write down <em>points</em>, and how they are connected: a list that can be drawn as it stands. That is an{" "}
            <Term id="explicit">explicit</Term> shape. Or you can write down a <em>rule</em> that takes any point of space and says whether it is in or out: an{" "}
            <Term id="implicit">implicit</Term> shape.
          </p>
          <p>
            Everything after depends on the choice: how you draw, cut and store it, and how you know that it is right. We follow points until the teapot is on the screen,
            then start again from the rule.
          </p>
        </>
      ),
    },
    plane: {
      title: "Three points are one plane, always",
      text: (
        <p>
          Put three points anywhere, but not on one line. There is one plane through them, so a triangle is always <Term id="planar">planar</Term>: one{" "}
          <Term id="normal">normal</Term>, one inside. A fourth corner may leave that plane. Here D is lifted, and the four corners no longer say what lies between
          them.
        </p>
      ),
      after: (
        <p>
          Drag this number: with D at <Handle figure="quad" field="height" value={0.9} low={0} high={1.5} step={0.05} name="Height of corner D" />, the middles of the two diagonals
          part by half of that. Authors model with quads all the same: they are good to work with. On the way to the screen the pipeline quietly cuts each one in two.
        </p>
      ),
    },
    inside: {
      title: "Inside is three signs",
      text: (
        <>
          <p>
            A triangle is also always <Term id="convex">convex</Term>. So a point is inside if it lies on the same side of all three edges. Which side,
            says the sign of an <Term id="edge-function">edge function</Term>: for the edge from a to b, twice the signed area of the triangle a, b, p:
          </p>
          <Formula>
            E(p) = (b<sub>x</sub> − a<sub>x</sub>)(p<sub>y</sub> − a<sub>y</sub>) − (b<sub>y</sub> − a<sub>y</sub>)(p<sub>x</sub> − a<sub>x</sub>)
          </Formula>
          <p>
            Drag the point over one edge, and exactly one sign turns: it is <Set figure="inside" to={{ probe: [9.4, 5.6] }}>outside</Set>. Reverse the order of the
            corners, and all three turn.
          </p>
        </>
      ),
    },
    pixels: {
      title: "So a screen can fill it",
      text: (
        <p>
          Ask these three signs at the centre of every pixel, and you have drawn the triangle: <Term id="rasterization">rasterization</Term>. From one pixel to the next
          each edge function changes by a constant, and no pixel waits for its neighbour, so hardware asks thousands at once. It is built for exactly the guarantees that
          a triangle gives.
        </p>
      ),
    },
    weights: {
      title: "Three weights, and only one way",
      text: (
        <>
          <p>
            Divide the three edge functions by their sum, twice the whole area, and you have three <Term id="barycentric">barycentric</Term> weights that sum to one,
            each for the corner opposite its edge. What is stored at the corners, a colour, a normal, a place in a texture, is blended by them, in one way only:
          </p>
          <Formula>
            p = w₀a + w₁b + w₂c,&ensp; w₀ + w₁ + w₂ = 1
          </Formula>
          <p>
            With <Set figure="weights" to={{ corners: "4" }}>four corners</Set> there is no such blend: the colour in the middle depends on the diagonal somebody
            chose. Back to <Set figure="weights" to={{ corners: "3" }}>three</Set>.
          </p>
        </>
      ),
    },
    tangent: {
      title: "A picture on it",
      text: (
        <p>
          Blend two numbers, u and v, and a picture lies on the triangle: these are its <Term id="uv">UV coordinates</Term>. Since the blend is linear, a step along
          u, with v held, is the same arrow everywhere on the face: its <Term id="tangent">tangent</Term>. With the normal it says which way a bump in the picture
          tilts the light.
        </p>
      ),
    },
    fan: {
      title: "Nothing is lost",
      text: (
        <p>
          Any convex polygon with n corners fans into n − 2 triangles from one corner, and every polygon that does not cross itself, however
          crooked, has a <Term id="triangulation">triangulation</Term> into n − 2. So we may speak of triangles only, and speak of everything.
        </p>
      ),
    },
    indexed: {
      title: "Store each corner once",
      text: (
        <p>
          The teapot before you is a <Term id="mesh">mesh</Term> of {say.whole(facts.indexed.triangles)} triangles. Written one by one, each brings its three corners: nine numbers, 36 bytes. But
          neighbours share their corners.
        </p>
      ),
      after: (
        <>
          <p>
            So store each vertex once, in a <Term id="vertex-buffer">vertex buffer</Term>, and let triangles name their corners by number, in an{" "}
            <Term id="index-buffer">index buffer</Term>: 12 bytes a vertex and 6 a triangle instead of 36 a triangle. Here that is{" "}
            {say.bytes(facts.indexed.bytes)} instead of {say.bytes(facts.indexed.unindexed_bytes)}. Normals, colours and UVs ride along, stored once, too.
          </p>
          <p>
            Press a vertex: the yellow triangles are all that use it, and move with it. Then see the same mesh{" "}
            <Set figure="indexed" to={{ storage: "unindexed" }}>without an index</Set>.
          </p>
        </>
      ),
    },
    cross: {
      title: "Which way a face looks",
      text: (
        <>
          <p>
            The normal of a face is perpendicular to two of its sides. Their <Term id="cross-product">cross product</Term> is, too; its length is twice the area, so
            it is scaled to one:
          </p>
          <Formula>n = normalize((v₁ − v₀) × (v₂ − v₀))</Formula>
        </>
      ),
    },
    normals: {
      title: "Where normals live is the whole difference",
      text: (
        <p>
          One normal a face gives one flat tone a facet: right for a cut gem, wrong for a teapot. Average the normals of the faces around each vertex, interpolate
          them over the triangles, and the same coarse mesh looks round. That is all there is to <Term id="shading">flat and smooth shading</Term>: no triangle moves. Average
          only across edges that bend by less than{" "}
          <Handle figure="normals" field="crease" value={0} low={0} high={180} step={5} unit="°" name="Crease angle" />, and watch the facets go.
        </p>
      ),
      after: (
        <p>
          Averaging across an edge that is meant to be hard smears it. So its vertices are split, and each side keeps its own normal: a{" "}
          <Set figure="normals" to={{ shape: "cube", crease: 60, arrows: true, view: { azimuth: -58, elevation: 26, distance: 8.8, target: [0, 0, 0] } }}>cube with hard edges</Set>.
        </p>
      ),
    },
    winding: {
      title: "Which side is the front",
      text: (
        <>
          <p>
            Seen from the front, the corners of a triangle run counter-clockwise: its <Term id="winding">winding</Term>. Of a closed shape you see only fronts, so{" "}
            <Term id="culling">culling</Term> skips every triangle that shows its back, about half of them, before any pixel is touched.
          </p>
          <p>
            Three triangles of this ball are wound the wrong way. Drawn from both sides and unlit the ball would look perfect; culled, it has three holes.{" "}
            <Set figure="culling" to={{ backs: "painted" }}>Paint the backs</Set> to see them, and turn each one over.
          </p>
        </>
      ),
    },
    manifold: {
      title: "When there is an inside",
      text: (
        <p>
          A mesh is closed and <Term id="manifold">manifold</Term> if each of its edges has exactly two triangles, and those around each vertex form one ring. Then
          inside and outside are clear, and a solid can be subdivided, cut from another, or dropped on the floor. A hole breaks that. So does a{" "}
          <Term id="t-junction">T-junction</Term>, where a vertex of one triangle sits on the edge of another without being shared. Two meshes can look alike at rest
          and differ as soon as they are lit, culled or cut. Choose a patient: each fault has a name, and a cure.
        </p>
      ),
    },
    bernstein: {
      title: "Four points and a curve",
      text: (
        <>
          <p>
            Nobody sculpts a teapot triangle by triangle. Its author placed <Term id="control-point">control points</Term>, sixteen for each patch of surface, and four
            for a curve, a <Term id="bezier">cubic Bézier</Term>. These four are the spout’s lower side. At t the curve blends its four points by the <Term id="bernstein">Bernstein</Term> weights:
          </p>
          <Formula>
            (1 − t)³ P₀ + 3t(1 − t)² P₁ + 3t²(1 − t) P₂ + t³ P₃
          </Formula>
          <p>
            From t = 0 to 1 they are never negative and sum to one, so the curve stays in the <Term id="convex-hull">convex hull</Term> of its points. It starts at P₀
            toward P₁, and ends at P₃, coming from P₂. The discs show how much each point pulls at t ={" "}
            <Handle figure="bernstein" field="t" value={0.35} low={-0.1} high={1.1} step={0.05} name="t" />. Go past 1: a weight turns negative, and the curve leaves.
          </p>
          <p>
            <Term id="de-casteljau">De Casteljau’s</Term> construction needs no weights at all: blend neighbours, four points to three, to two, to one. Point, tangent,
            and both parts of the curve come for free.
          </p>
        </>
      ),
    },
    runge: {
      title: "Why not one long polynomial",
      text: (
        <p>
          Through eleven points runs exactly one polynomial of degree at most ten. Between them it may swing far out: <Term id="runge">Runge’s phenomenon</Term>.
        </p>
      ),
      after: (
        <p>
          A chain of short cubics, a <Term id="spline">spline</Term>, bends near the point that you move and hardly anywhere else. Lift the middle one to{" "}
          <Handle figure="runge" field="lift" value={0.15} low={-1.5} high={1.5} step={0.05} name="Lift of the middle point" /> and compare the two.
        </p>
      ),
    },
    spline: {
      title: "Many short cubics",
      text: (
        <p>
          Low degree keeps each piece calm, and many pieces keep control local: a point moves a stretch of the curve, not all of it. So the question moves to where the
          pieces meet.
        </p>
      ),
    },
    joins: {
      title: "How well they meet",
      text: (
        <p>
          <Term id="continuity">C0</Term>: one piece begins where the other ends, with a kink perhaps. C1: they share direction and speed. C2: they share bending, too.
          The line hardly shows the difference between C1 and C2; a <Set figure="joins" to={{ keep: "C1" }}>reflection</Set> does: its stripes kink where the{" "}
          <Term id="curvature">curvature</Term> jumps. Keep <Set figure="joins" to={{ keep: "C2" }}>C2</Set>, and they run on.
        </p>
      ),
    },
    ride: {
      title: "How it feels to ride along",
      text: (
        <p>
          A camera on a C1 path never jumps, but it jerks: where the bending changes at once, so does the sideways push. Roller coasters, milling machines and camera
          flights want C2.
        </p>
      ),
    },
    patch: {
      title: "From curves to surfaces",
      text: (
        <p>
          Let the four points of a curve run along four curves themselves, and it sweeps a surface: a <Term id="tensor-product">tensor product</Term> patch with 4 × 4
          control points. This one is half of the spout; the first curve is one of its sides. The teapot, drawn by Martin Newell in 1975, is{" "}
          {say.whole(facts.teapot.patches)} of them: {say.bytes(facts.teapot.bytes)} of text, and smooth at any size.
        </p>
      ),
    },
    cage: {
      title: "Or cut a cage until it is smooth",
      text: (
        <p>
          Artists would rather push a coarse mesh of quads about, a <Term id="cage">cage</Term>. <Term id="subdivision">Subdivision</Term> by Catmull and Clark splits each
          quad into four and averages: after{" "}
          <Handle figure="cage" field="level" value={2} low={0} high={5} name="Rounds" /> rounds it is hard to tell from its smooth limit. Each round has four times the
          faces and leaves about a quarter of the error. At the last moment, patch or cage, all becomes triangles.
        </p>
      ),
    },
    pull: {
      title: "Pull the cage",
      text: (
        <p>
          Move one corner of a cage, and the surface follows: most beside it, here by {say.number(facts.pull)} of its way, and not at all beyond two rings of faces, which on a cube is everything.
        </p>
      ),
    },
    segments: {
      title: "How many segments until it looks smooth?",
      text: (
        <p>
          Turning a smooth shape into straight pieces is <Term id="tessellation">tessellation</Term>; this is its question in the flat. Between two points a curve runs a
          little beside the <Term id="chord">chord</Term>. If that gap is less than half a pixel, nobody sees it.
        </p>
      ),
      after: (
        <p>
          The error falls like 1/N²: with 8 segments {say.number(facts.segments.gaps.get(8)!)} px, with 16 {say.number(facts.segments.gaps.get(16)!)}, with 32{" "}
          {say.number(facts.segments.gaps.get(32)!)}. Large gains first, then small ones. Now it has{" "}
          <Handle figure="segments" field="count" value={6} low={1} high={64} name="Segments" /> segments. It takes{" "}
          {say.whole(facts.segments.evenly)} to prove half a pixel everywhere; spent <Set figure="segments" to={{ how: "fewest" }}>where it bends</Set>, {say.whole(facts.segments.fewest)}.
        </p>
      ),
    },
    cracks: {
      title: "One side, cut once",
      text: (
        <p>
          Two patches that share a side must cut it at the same points. If each chooses its own number, their triangles part, and light shows through the crack.
        </p>
      ),
    },
    field: {
      title: "A number for every point",
      text: (
        <>
          <p>
            Start again, with a rule. Give every point of space a number, its distance to the shape, negative inside: a{" "}
            <Term id="signed-distance">signed distance</Term>. A ball takes one line:
          </p>
          <Formula>f(p) = |p| − r</Formula>
          <p>
            Inside is one sign. The normal is the <Term id="gradient">gradient</Term>, scaled to one: a few samples close together. Drag the point: the circle around it
            is as large as the value, and never reaches across the shape. <Set figure="field" to={{ asked: "mesh" }}>Ask the mesh</Set> the same, and it searches{" "}
            {say.whole(facts.field.edges)} edges.
          </p>
        </>
      ),
    },
    tracing: {
      title: "Rays that leap",
      text: (
        <p>
          To draw a field, send a ray through each pixel. How far may it go at once? As far as the value says, since nothing is nearer:{" "}
          <Term id="sphere-tracing">sphere tracing</Term>.
        </p>
      ),
      after: (
        <p>
          Through open space it leaps; grazing the surface it creeps: of all rays of this picture the slowest takes {say.whole(facts.tracing.most)} steps. Follow
          yours for <Handle figure="tracing" field="shown" value={4} low={0} high={40} name="Steps shown" />.
        </p>
      ),
    },
    csg: {
      title: "A hole in one line",
      text: (
        <p>
          Union is min(a, b), intersection max(a, b), and subtraction max(a, −b). That is <Term id="csg">constructive solid geometry</Term>: a hole through a block in one
          line, and every sign is right. The value is no longer a distance everywhere, only a bound from below, so rays still never step too far.
        </p>
      ),
    },
    blend: {
      title: "Round the seam",
      text: (
        <p>
          Take a minimum that rounds its corner, and two shapes flow into each other where they meet, by as much as you like. On a mesh a rounded seam is a project; here it
          is the same line.
        </p>
      ),
    },
    booleans: {
      title: "The same with triangles",
      text: (
        <p>
          Between two meshes the same hole is fiddly. Every triangle has to be cut against every one that it meets, rounding moves the cut points, and where three faces
          meet in almost one point, naive code leaves cracks. It can be done exactly; it is never one line.
        </p>
      ),
    },
    squares: {
      title: "Back to triangles",
      text: (
        <p>
          Hardware draws triangles, so fields are turned into them. Sample the field on a lattice. In each cell, see which corners are inside, put a vertex on every
          edge whose ends differ, and join them: <Term id="marching-cubes">marching cubes</Term>, in the flat marching squares. Sharp corners are cut off, unless the mesher knows the
          parts and puts a vertex <Set figure="squares" to={{ method: "corners" }}>where they meet</Set>.
        </p>
      ),
    },
    cubes: {
      title: "A whole surface, cell by cell",
      text: (
        <p>
          In space a cell has eight corners, and 256 ways to be in or out. Go through all cells, and a surface appears that is closed by construction, if neighbours
          read the face that they share in the same way.
        </p>
      ),
    },
    network: {
      title: "A rule that was learned",
      text: (
        <p>
          The rule need not be written by hand. In 3-D vision a network is trained, from photographs or scans, to say of any point whether it is{" "}
          <Term id="occupancy">occupied</Term>; to see what it has learned, one marches cubes over it.
        </p>
      ),
    },
    baking: {
      title: "There and back",
      text: (
        <p>
          Engines carry both answers and convert. To collide or blend, the teapot’s {say.whole(facts.baking.triangles)} triangles are{" "}
          <Term id="baking">baked</Term> into distances on a lattice, here {say.whole(facts.baking.samples)} samples, and meshed again into{" "}
          {say.whole(facts.baking.back)}. Each way loses something, and each loss can be bounded. With only{" "}
          <Handle figure="baking" field="cells" value={20} low={6} high={36} name="Cells along the longest side" /> cells along its side, see what becomes of the
          handle.
        </p>
      ),
    },
    table: {
      title: "Side by side",
      text: <p>One shape, written down both ways and measured. Neither wins. To draw fast: a mesh. To carve, blend and query: a field.</p>,
    },
    budget: {
      title: "What half the error costs",
      text: (
        <p>
          More triangles shrink the gap to the true surface, round the outline and smooth the shading, and each costs memory and work. Half the error takes{" "}
          {say.fixed(facts.budget.curve, 1)} times the segments on a curve and {facts.budget.surfaces.map((times) => say.fixed(times, 1)).join(" to ")} times the triangles on a surface, be it patches, a cage or a field. So the first thousand triangles buy almost everything, and
          the last million almost nothing.
        </p>
      ),
    },
    overshade: {
      title: "The cliff below a pixel",
      text: (
        <p>
          Graphics hardware shades pixels in blocks of 2 × 2, even if a triangle covers only one of them. Large triangles do not mind. But let their sides shrink
          to <Handle figure="overshade" field="stop" value={9} low={0} high={26} name="Side of a triangle" shown={SIDES.map((side) => `${side} px`)} />.
        </p>
      ),
      after: (
        <p>
          This is <Term id="overshading">overshading</Term>. And most of those triangles fall between the pixel centres and are never seen: they cost, and give nothing.
        </p>
      ),
    },
    shimmer: {
      title: "And it shimmers",
      text: (
        <p>
          Worse than nothing: which of many tiny triangles a pixel centre hits changes from frame to frame, so a turning surface sparkles. This is{" "}
          <Term id="aliasing">aliasing</Term>: more detail than samples to show it.
        </p>
      ),
    },
    levels: {
      title: "One pixel, near and far",
      text: (
        <p>
          So keep the shape in several <Term id="lod">levels of detail</Term>, each within some length, and measure that length on the screen, in{" "}
          <Term id="screen-space">screen space</Term>. From{" "}
          <Handle figure="levels" field="stop" value={0} low={0} high={18} name="Camera to teapot" shown={DISTANCES.map((distance) => metres(say, distance))} /> away the
          coarsest level within one pixel is shown. From {metres(say, DISTANCES[6]!)} the teapot is {say.whole(facts.levels.smallPixels)}{" "}
          pixels wide, and {say.whole(facts.levels.small.teapot)} triangles are enough.
        </p>
      ),
      after: (
        <p>
          Both are one pixel off at most. That is {metres(say, facts.levels.pixel.teapot)} on the teapot, and{" "}
          {metres(say, facts.levels.pixel.mountain)} on the mountain. Step back to <Set figure="levels" to={{ stop: 4 }}>{metres(say, DISTANCES[4]!)}</Set>, and the teapot needs {say.whole(facts.levels.far.teapot)}; the mountain does not notice.
        </p>
      ),
    },
    adaptive: {
      title: "Finer where it shows",
      text: (
        <p>
          A level need not be even. Triangles should crowd where the surface bends, near the camera, and along the <Term id="silhouette">silhouette</Term>, where straight
          edges show against the background; flat and far parts need few. Along the outline every chord is within the budget, here{" "}
          <Handle figure="adaptive" field="stop" value={4} low={0} high={6} name="Budget" shown={BUDGETS.map((px) => `${say.number(px)} px`)} />; a face that looks at you
          may be off by more, along the line of sight.
        </p>
      ),
    },
    mountain: {
      title: "At their true size",
      text: (
        <p>
          Both in one picture, within {say.number(facts.mountain.pixels)} pixels. Move the loupe along an edge: grey is the true surface, blue the triangles, each square a
          pixel. Nowhere do they part by more. The teapot, {metres(say, facts.mountain.distance)} away, takes {say.whole(facts.mountain.teapot)} triangles, and this mountain, with more ridges than
          the last one, {say.whole(facts.mountain.mountain)}.
        </p>
      ),
    },
  }),
  table: ({ rivals }, say) => (
    <table class="rivals">
      <caption>A block, 2 wide, with a hole through it. The mesh is at most {say.number(rivals.bound)} off, proved.</caption>
      <thead>
        <tr>
          <td />
          <th scope="col">Mesh: a list of points</th>
          <th scope="col">Field: a rule</th>
        </tr>
      </thead>
      <tbody>
        <tr>
          <th scope="row">What the shape is</th>
          <td>
            {say.whole(rivals.triangles)} triangles, {say.bytes(rivals.bytes)}
          </td>
          <td>max(block, −hole): {say.whole(rivals.operations)} operations</td>
        </tr>
        <tr>
          <th scope="row">Drawing</th>
          <td>as it is, each triangle once</td>
          <td>
            {say.fixed(rivals.steps, 1)} steps a ray, up to {say.whole(rivals.most_steps)}; or mesh it first
          </td>
        </tr>
        <tr>
          <th scope="row">Inside test</th>
          <td>a search: up to {say.whole(rivals.triangles)} triangles</td>
          <td>one value, one sign</td>
        </tr>
        <tr>
          <th scope="row">Booleans</th>
          <td>
            {say.whole(rivals.operands[0])} × {say.whole(rivals.operands[1])} = {say.whole(rivals.pairs)} pairs of triangles that may cut each other
          </td>
          <td>one max, one line</td>
        </tr>
        <tr>
          <th scope="row">Normals</th>
          <td>stored: {say.whole(rivals.normals)} of them</td>
          <td>the gradient, from a few samples</td>
        </tr>
      </tbody>
    </table>
  ),
  guesses: (facts, say) => ({
    plane: {
      ask: "One corner of a square is lifted. Which way does the middle bulge?",
      options: { up: "Up", down: "Down", both: "Either: it depends" },
      answer: (
        <>
          It depends on the diagonal. Cut along one, the middle is a ridge, along the other a valley, and the four corners do not say which. Here D
          stands {say.number(facts.bulge)} out of the plane of the other three.
        </>
      ),
    },
    indexed: {
      ask: "How many triangles share a vertex, on average?",
      unit: "triangles",
      answer: (
        <>
          {say.number(facts.indexed.triangles_per_vertex)} here, and close to six in any large closed mesh: it has half as many vertices as triangles, and each triangle
          has three corners.
        </>
      ),
    },
    normals: {
      ask: "A cube has 8 corners. How many vertices does it have in a game?",
      options: { "8": "8", "24": "24", "36": "36" },
      answer: (
        <>
          {say.whole(facts.cube.hard)}: three at each corner, one for each face that meets there, each with its own normal. With averaged normals{" "}
          {say.whole(facts.cube.soft)} would do, and it would look like a soap bar.
        </>
      ),
    },
    runge: {
      ask: "Move the middle one of eleven points. How much of the polynomial moves?",
      options: { near: "What is near the point", half: "About half of it", everywhere: "All of it" },
      answer: <>All of it, and it may move most near the far ends. One polynomial has no “near”: every coefficient depends on every point.</>,
    },
    segments: {
      ask: "Cut in equal steps, how many segments until this curve is within half a pixel?",
      unit: "segments",
      answer: (
        <>
          {say.whole(facts.segments.seen)}. With a thousand more it would look the same.
        </>
      ),
    },
    tracing: {
      ask: "How many steps does the ray in the figure take to the surface?",
      unit: "steps",
      answer: <>{say.whole(facts.tracing.steps)}. The last ones are the shortest: near the surface the value is small.</>,
    },
    overshade: {
      ask: `Triangles with sides of ${SIDES.at(-1)} px cover the screen. How often is each pixel shaded?`,
      unit: "times",
      answer: (
        <>
          {say.number(facts.overshade.below)} times: a whole 2 × 2 block for every pixel. With sides of {SIDES[0]} px it is {say.number(facts.overshade.above)} times.
        </>
      ),
    },
    levels: {
      ask: `A teapot ${metres(say, DISTANCES[0]!)} away, a mountain range ${metres(say, facts.levels.behind)} behind it. Which needs more triangles?`,
      options: { teapot: "The teapot", same: "About the same", mountain: "The mountain" },
      answer: (
        <>
          The teapot: {say.whole(facts.levels.near.teapot)} triangles against {say.whole(facts.levels.near.mountain)}, though the mountain is {say.whole(facts.levels.wider)}{" "}
          times as wide.
        </>
      ),
    },
  }),
  terms: {
    explicit: { word: "explicit", formula: <>points p₀, p₁, p₂, … and who is joined to whom</>, gloss: "A shape given by listing its points and how they are connected. It can be drawn as it stands." },
    implicit: { word: "implicit", formula: <>the shape is where f(p) = 0</>, gloss: "A shape given by a rule that can be asked at any point. It can be tested at once, and must be searched to be drawn." },
    planar: { word: "planar", formula: <>n · (p − a) = 0</>, gloss: "All of it lies in one plane. Three points always do." },
    normal: { word: "normal", formula: <>n · (p − a) = 0 for all p of the plane, |n| = 1</>, gloss: "The unit vector perpendicular to a surface. Light is computed from it." },
    convex: { word: "convex", gloss: "A straight line between two of its points never leaves it. A triangle always is, a polygon may not be." },
    "edge-function": {
      word: "edge function",
      formula: <>E(p) = (b − a) × (p − a)</>,
      gloss: "Twice the signed area of a, b and p: positive if p lies to the left of the edge from a to b.",
    },
    rasterization: { word: "rasterization", gloss: "Deciding which pixels a triangle covers, by its three edge functions at their centres." },
    barycentric: {
      word: "barycentric weights",
      formula: <>p = w₀a + w₁b + w₂c, w₀ + w₁ + w₂ = 1</>,
      gloss: "The one way to write a point as a blend of three corners. All three are positive inside.",
    },
    uv: { word: "UV coordinates", gloss: "Two numbers at each corner that say which place of a picture lies there." },
    tangent: { word: "tangent", formula: <>T = ∂p/∂u</>, gloss: "How a point of the surface moves as u grows and v stays. On a flat triangle it is the same everywhere." },
    triangulation: { word: "triangulation", formula: <>n corners, n − 2 triangles</>, gloss: "Cutting a polygon into triangles by diagonals. Every simple polygon has one." },
    mesh: { word: "mesh", formula: <>vertices, and triangles between them</>, gloss: "A surface of triangles that share vertices and edges." },
    "vertex-buffer": { word: "vertex buffer", formula: <>12 bytes: x, y, z as 32-bit floats</>, gloss: "The list of vertices, each stored once with all that belongs to it." },
    "index-buffer": { word: "index buffer", formula: <>6 bytes: three 16-bit numbers</>, gloss: "For each triangle the numbers of its three vertices. Beyond 65,536 vertices they take 32 bits each." },
    "cross-product": {
      word: "cross product",
      formula: (
        <>
          (a<sub>y</sub>b<sub>z</sub> − a<sub>z</sub>b<sub>y</sub>, a<sub>z</sub>b<sub>x</sub> − a<sub>x</sub>b<sub>z</sub>, a<sub>x</sub>b<sub>y</sub> − a<sub>y</sub>b<sub>x</sub>)
        </>
      ),
      gloss: "A vector perpendicular to a and b, as long as the parallelogram that they span is large. Swapped, it points the other way.",
    },
    shading: { word: "flat and smooth shading", gloss: "One normal for each face, or one for each vertex, interpolated over the faces." },
    winding: { word: "winding", gloss: "The order of a triangle’s corners. Counter-clockwise, seen from the front, by convention." },
    culling: { word: "back-face culling", formula: <>skip if n · (eye − p) &lt; 0</>, gloss: "Not drawing triangles that show their back, which on a closed shape are always hidden." },
    manifold: { word: "manifold", formula: <>every edge: two triangles</>, gloss: "Around each point the surface looks like a disc. Together with closed, it has an inside." },
    "t-junction": { word: "T-junction", gloss: "A vertex on the edge of a neighbour that does not have it. Rounding opens a crack there." },
    "control-point": { word: "control point", gloss: "A point that pulls a curve or surface without lying on it, in general." },
    bezier: {
      word: "cubic Bézier curve",
      formula: (
        <>
          Σ B<sub>i</sub>(t) P<sub>i</sub>, i = 0 … 3
        </>
      ),
      gloss: "A curve by four points: two ends, and two that it leaves toward and comes from.",
    },
    bernstein: {
      word: "Bernstein polynomials",
      formula: (
        <>
          B<sub>i</sub>(t) = C(3, i) t<sup>i</sup> (1 − t)<sup>3−i</sup>
        </>
      ),
      gloss: "The weights of a Bézier curve’s control points: never negative from 0 to 1, and their sum is 1.",
    },
    "convex-hull": { word: "convex hull", gloss: "The smallest convex shape around some points: what a rubber band around them encloses." },
    "de-casteljau": { word: "de Casteljau’s algorithm", formula: <>lerp(p, q, t) = (1 − t)p + tq: 4 → 3 → 2 → 1</>, gloss: "Evaluates a Bézier curve by blending neighbours until one point is left." },
    runge: { word: "Runge’s phenomenon", gloss: "A polynomial through ever more equally spaced points may swing ever wider near the ends." },
    spline: { word: "spline", gloss: "A curve of many pieces of low degree that meet smoothly." },
    continuity: { word: "C0, C1, C2", formula: <>equal values; first derivatives, too; second, too</>, gloss: "How smoothly two pieces meet: position, direction and speed, bending." },
    curvature: { word: "curvature", formula: <>κ = |c′ × c″| / |c′|³</>, gloss: "How fast the direction turns along a curve: one divided by the radius of the circle that fits." },
    "tensor-product": {
      word: "tensor product",
      formula: (
        <>
          Σ B<sub>i</sub>(u) B<sub>j</sub>(v) P<sub>ij</sub>
        </>
      ),
      gloss: "A surface whose weights are products of those of two curves. A bicubic patch has 4 × 4 points.",
    },
    cage: { word: "cage", gloss: "A coarse control mesh, mostly of quads, that a smooth surface follows without touching it." },
    subdivision: { word: "subdivision surface", formula: <>faces × 4 each round</>, gloss: "The limit of splitting a cage’s faces and averaging its vertices, again and again." },
    tessellation: { word: "tessellation", gloss: "Turning a smooth shape into triangles, or a curve into segments." },
    chord: { word: "chord", formula: <>gap ≤ max|c″| h² / 8</>, gloss: "The straight line between two points of a curve. Half the step h, a quarter of the gap." },
    "signed-distance": { word: "signed distance", formula: <>of a ball: f(p) = |p| − r</>, gloss: "How far it is to the nearest point of the surface, negative inside." },
    gradient: { word: "gradient", formula: <>∇f = (∂f/∂x, ∂f/∂y, ∂f/∂z)</>, gloss: "The direction in which a field grows fastest. Of a distance it has length 1, and on the surface it is the normal." },
    "sphere-tracing": { word: "sphere tracing", formula: <>t ← t + f(eye + t · way)</>, gloss: "Following a ray by steps as long as the field says is safe." },
    csg: { word: "constructive solid geometry (CSG)", formula: <>min(a, b), max(a, b), max(a, −b)</>, gloss: "Building solids by union, intersection and difference of simple ones." },
    "marching-cubes": { word: "marching cubes", formula: <>2⁸ = 256 cases</>, gloss: "Triangles from samples of a field, one lattice cell at a time, by the signs of its corners." },
    occupancy: { word: "occupancy", formula: <>o(p) ∈ [0, 1], surface at ½</>, gloss: "How sure one is that a point is inside: what vision networks learn." },
    baking: { word: "baking", gloss: "Computing a field’s values once and storing them on a lattice." },
    overshading: { word: "overshading", formula: <>pixels shaded ÷ pixels covered</>, gloss: "Shading work for pixels that a triangle does not cover, because hardware shades blocks of 2 × 2." },
    aliasing: { word: "aliasing", gloss: "Detail finer than the samples appears as false, flickering coarse detail." },
    lod: { word: "level of detail (LOD)", gloss: "The same shape with fewer triangles, for use from farther away." },
    "screen-space": { word: "screen-space error", formula: <>pixels ≈ length ÷ distance × height ÷ (2 tan(fov/2))</>, gloss: "An error as it is seen: its length in pixels at its distance." },
    silhouette: { word: "silhouette", formula: <>where n · (eye − p) = 0</>, gloss: "The outline: where the surface turns from front to back. Coarse triangles show there first." },
  },
  questions: {
    title: "Six questions",
    lead: "Answer in your own words, then turn the card: behind each is a number, and a figure to check it.",
    cards: (facts, say) => ({
      triangles: {
        ask: "Why triangles?",
        answer: (
          <>
            Three corners always lie in one plane, span a convex shape, and blend what they carry in one way only. A fourth can leave the plane, here by{" "}
            {say.number(facts.bulge)}, and then the surface depends on a diagonal that nobody stored.
          </>
        ),
        figure: "plane",
      },
      normals: {
        ask: "How is a face normal computed, and what makes shading flat or smooth?",
        answer: (
          <>
            By the cross product of two sides, scaled to length one. One for each face is flat, averages at the vertices are smooth; a hard edge keeps both, so a cube
            has {say.whole(facts.cube.hard)} vertices.
          </>
        ),
        figure: "normals",
      },
      winding: {
        ask: "What does winding encode, and why does culling hang on it?",
        answer: (
          <>
            Which side is the front: seen from there the corners run counter-clockwise. Culling skips what shows its back, {say.percent(facts.culling.back_share)} of the
            ball here, and knows only the order. A triangle with the wrong one is a hole.
          </>
        ),
        figure: "winding",
      },
      joins: {
        ask: "What are C0, C1 and C2, and why many pieces of low degree?",
        answer: (
          <>
            C0: the pieces meet; C1: with the same direction and speed; C2: with the same bending, too, as a camera path needs; for a reflection equal curvature is enough
            (G2). Many short pieces stay calm and local: lift one of eleven points by {say.number(facts.runge.lift)}, and beyond its neighbours the spline moves by{" "}
            {say.number(facts.runge.spline)}, one polynomial by {say.number(facts.runge.polynomial)}.
          </>
        ),
        figure: "joins",
      },
      fields: {
        ask: "What are mesh and field each good at, and bad at?",
        answer: (
          <>
            A mesh is drawn at once; its inside and its booleans need a search. A field answers inside, distance and booleans in a line; to be drawn it takes{" "}
            {say.fixed(facts.rivals.steps, 1)} steps a ray, or a mesh.
          </>
        ),
        figure: "table",
      },
      cost: {
        ask: "Are more triangles always better?",
        answer: (
          <>
            Yes, until every chord is within a pixel. Beyond that they show nothing new; smaller than a pixel, they shade each one {say.number(facts.overshade.below)}{" "}
            times, and shimmer.
          </>
        ),
        figure: "overshade",
      },
    }),
  },
  ending: {
    title: "Match the budget to what can be seen, and stop when the eye can no longer tell.",
    text: (
      <>
        That is what Chordal does for your own shapes: you say how much error may be seen, and it returns triangles with a proof of how far they are off.
      </>
    ),
  },
};
