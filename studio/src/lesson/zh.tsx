// The lesson in Chinese.
// Long because the texts of one language stand in one file, in the order of the page.
import { STOPS as BUDGETS } from "../exhibits/adaptive";
import { STOPS as DISTANCES, metres } from "../exhibits/levels";
import { STOPS as SIDES } from "../exhibits/overshade";
import type { LessonText } from "./lesson";
import { Formula, Handle, Set, Term } from "./parts";

export const ZH: LessonText = {
  title: "形状该怎么写下来？· Chordal",
  description: "三角形、曲线、场，以及它们的代价，一页讲完：从茶壶的第一个控制点，到它的最后一个三角形。先猜，再动手；每个数字都当着你的面算出来。",
  words: {
    skip: "跳到图形",
    sections: "五步",
    elsewhere: "Chordal 的其他页面",
    onward: "接下来去哪里",
    exhibits: "展品",
    bench: "工作台",
    workbench: "工作台：换上你自己的形状",
    widget: "小实验：要分多少段，曲线看起来才光滑？",
    begin: "开始：半小时",
    distance: "离你多远",
    seenFrom: (distance, pixels) => `从 ${distance} 外看到的样子，宽 ${pixels} 像素`,
    upClose: "同样的三角形，拿到眼前",
    enough: (pixels) => `个三角形就够了：误差至多 ${pixels} 像素，已证明`,
    spokenAt: (distance, triangles) => `${distance}，${triangles} 个三角形`,
    all: (triangles) => `与 ${triangles} 个的相比`,
    heroPicture: "同一个茶壶画两次：远看的样子，和放大后的三角形",
    asPoints: "清单：八个点，各与下一个相连",
    asRule: "规则：负的在里面",
    again: "再放一遍",
    ownPage: "这幅图自己的页面，可试的更多",
    guess: "先猜一猜。",
    yourGuess: "你猜",
    reveal: "揭晓",
    showAnswer: "答案",
    close: "你猜 {guess}，很接近。",
    far: "你猜 {guess}。看看实际：",
    right: "对，{guess}。",
    wrong: "你猜“{guess}”。看看实际：",
    code: "代码",
    copy: "复制",
    copied: "已复制",
    terms: "术语",
    termsLead: "本页用到的全部术语；有公式的，附上公式。",
    showTerms: "展开全部术语",
    showTable: "展开对照表",
    backToText: "回到正文",
    closeTerm: "关闭",
    turn: "翻开",
    answerOf: "参考答案",
    yourAnswer: "用你自己的话写",
    seeFigure: "去看图",
    footer: "这里的每个数字都由 Chordal 的核心算出，命令行和程序库用的是同一份代码。任何数据都不会发送出去。没有 JavaScript 时图形静止，文字照样可读。",
  },
  hero: {
    question: "画一个茶壶，要多少个三角形？",
    sentence: (facts, say) => (
      <>
        摆在面前，{say.whole(facts.hero[0]!.triangles)} 个；放到院子对面，{say.whole(facts.rest)} 个就够，你看不出差别。为什么？跟着一个茶壶，从它的第一个控制点看到最后一个像素。
      </>
    ),
  },
  sections: {
    question: { kicker: "问题", title: "形状该怎么写下来？" },
    atom: { kicker: "第一步", title: "三角形是原子" },
    mesh: { kicker: "第二步", title: "网格存下百万个三角形" },
    smooth: { kicker: "第三步", title: "用光滑的曲线曲面造型" },
    field: { kicker: "第四步", title: "另一种回答：f(x) = 0" },
    cost: { kicker: "第五步", title: "代价" },
  },
  blocks: (facts, say) => ({
    two: {
      title: "两种回答",
      text: (
        <>
          <p>
            写下一个形状，办法有两种，彼此对立。一种是记下许多<em>点</em>，以及哪些点相连。这份清单拿来就能画，叫做<Term id="explicit">显式</Term>表示。另一种是给出一条
            <em>规则</em>：空间里随便指一点，它都能说出在里面还是外面，叫做<Term id="implicit">隐式</Term>表示。
          </p>
          <p>选了哪一种，后面的一切就跟着定了：怎么画，怎么切，怎么存，又凭什么说它没错。我们先走点的这条路，陪茶壶一直走到屏幕上；再回到起点，走规则的那条。</p>
        </>
      ),
    },
    plane: {
      title: "三点必共面",
      text: (
        <p>
          不共线的三个点，随你怎么放，过它们的平面恰好一个。所以三角形总是<Term id="planar">平</Term>的：<Term id="normal">法线</Term>只有一条，内部只有一种。第四个顶点却可以翘出去。图中 D
          抬起来了，四个顶点之间夹着什么样的面，就说不清了。
        </p>
      ),
      after: (
        <p>
          拖动这个数：D 抬到 <Handle figure="quad" field="height" value={0.9} low={0} high={1.5} step={0.05} name="D 的高度" />
          ，两条对角线的中点便隔开这个高度的一半。文件里只存了四个顶点，并没有存下作者想要的是哪一张面。四边形好摆弄，所以造型时照用不误；送上屏幕之前，渲染管线再悄悄把它们一分为二。
        </p>
      ),
    },
    inside: {
      title: "三个符号，分出内外",
      text: (
        <>
          <p>
            三角形还总是<Term id="convex">凸</Term>的。一个点只要在三条边的同一侧，就在里面。在哪一侧，看<Term id="edge-function">边函数</Term>
            的符号；从 a 到 b 的边，它的值是三角形 a、b、p 有向面积的两倍：
          </p>
          <Formula>
            E(p) = (b<sub>x</sub> − a<sub>x</sub>)(p<sub>y</sub> − a<sub>y</sub>) − (b<sub>y</sub> − a<sub>y</sub>)(p<sub>x</sub> − a<sub>x</sub>)
          </Formula>
          <p>
            把点拖过一条边，<Set figure="inside" to={{ probe: [9.4, 5.6] }}>到外面去</Set>，恰有一个符号会变。把三个顶点的次序倒过来，三个符号就一起翻转。
          </p>
        </>
      ),
    },
    pixels: {
      title: "屏幕就是这样填满它的",
      text: (
        <p>
          在每个像素的中心问一遍这三个符号，三角形就画好了。这叫<Term id="rasterization">光栅化</Term>
          。走到下一个像素，边函数的增量是个常数，像素之间谁也不等谁，硬件一次能问几千个。三角形保证了什么，硬件就照着什么来造。
        </p>
      ),
    },
    weights: {
      title: "三个权重，只有一种混法",
      text: (
        <>
          <p>
            三个边函数各除以三者之和（总面积的两倍），得到三个<Term id="barycentric">重心坐标</Term>，它们的和是一，各归所对的那个顶点。顶点上存着什么都行，颜色、法线、纹理上的位置，都按这三个权重混合，而且混法只有一种：
          </p>
          <Formula>
            p = w₀a + w₁b + w₂c,&ensp; w₀ + w₁ + w₂ = 1
          </Formula>
          <p>
            换成<Set figure="weights" to={{ corners: "4" }}>四个顶点</Set>就没有这样的混法了：中间是什么颜色，要看对角线当初怎么连。再换回
            <Set figure="weights" to={{ corners: "3" }}>三个顶点</Set>。
          </p>
        </>
      ),
    },
    tangent: {
      title: "贴上一张图",
      text: (
        <p>
          混合 u、v 两个数，一张图就贴在三角形上了，这两个数叫 <Term id="uv">UV 坐标</Term>。混合是线性的，所以 v 不变、只让 u
          增长，点在面上各处都朝同一个方向移动：这就是<Term id="tangent">切线</Term>。有了切线和法线，图里的凹凸才知道该让光往哪边偏。
        </p>
      ),
    },
    fan: {
      title: "什么也没丢",
      text: (
        <p>
          凸的 n 边形，从一个顶点出发，可以呈扇形分成 n − 2 个三角形；再曲折的多边形，只要不自交，也有<Term id="triangulation">三角剖分</Term>，不多不少，同样是 n − 2
          个。因此只谈三角形，就什么都谈到了。
        </p>
      ),
    },
    indexed: {
      title: "每个顶点只存一次",
      text: (
        <p>
          眼前的茶壶是一张<Term id="mesh">网格</Term>，由 {say.whole(facts.indexed.triangles)} 个三角形组成。逐个写出来，每个都得带上自己的三个顶点：九个数，36 字节。可是相邻的三角形本来就共用顶点。
        </p>
      ),
      after: (
        <>
          <p>
            那就把顶点各存一次，放进<Term id="vertex-buffer">顶点缓冲</Term>；三角形只报顶点的编号，放进<Term id="index-buffer">索引缓冲</Term>。一个顶点 12
            字节，一个三角形 6 字节，不再是每个三角形 36 字节。这个茶壶因此占 {say.bytes(facts.indexed.bytes)}，而不是{" "}
            {say.bytes(facts.indexed.unindexed_bytes)}。法线、颜色、UV 跟着顶点走，也只存一次。
          </p>
          <p>
            点一下某个顶点，黄色的就是用到它的全部三角形，它一动，它们都跟着动。再看看同一个网格<Set figure="indexed" to={{ storage: "unindexed" }}>不用索引</Set>会怎样。
          </p>
        </>
      ),
    },
    cross: {
      title: "一个面朝哪边",
      text: (
        <>
          <p>
            一个面的法线垂直于它的两条边，两条边的<Term id="cross-product">叉积</Term>也是。叉积的长度是面积的两倍，所以要缩放到一：
          </p>
          <Formula>n = normalize((v₁ − v₀) × (v₂ − v₀))</Formula>
        </>
      ),
    },
    normals: {
      title: "差别全在法线放在哪里",
      text: (
        <p>
          每个面一条法线，每个面就是一个平平的色块：宝石正该如此，茶壶却不行。把顶点周围各面的法线平均起来，再在三角形里插值，同样粗的网格看上去就圆了。所谓
          <Term id="shading">平直着色与平滑着色</Term>，区别仅此而已，三角形一个也没动。现在只在弯折小于{" "}
          <Handle figure="normals" field="crease" value={0} low={0} high={180} step={5} unit="°" name="折痕角" /> 的边上平均；加大它，看棱面一一消失。
        </p>
      ),
      after: (
        <p>
          有些棱本该是硬的，一平均就糊了。办法是把那里的顶点拆开，两边各用各的法线：看这个
          <Set figure="normals" to={{ shape: "cube", crease: 60, arrows: true, view: { azimuth: -58, elevation: 26, distance: 8.8, target: [0, 0, 0] } }}>棱角分明的立方体</Set>。
        </p>
      ),
    },
    winding: {
      title: "哪一面是正面",
      text: (
        <>
          <p>
            从正面看，三个顶点按逆时针排列，这就是<Term id="winding">环绕方向</Term>。封闭的形状，你看到的只有正面，于是<Term id="culling">背面剔除</Term>
            把背对视点的三角形全部跳过，大约省去一半，而且是在碰到任何像素之前。
          </p>
          <p>
            这个球上有三个三角形绕反了。两面都画、又不打光的时候完全看不出来；一剔除，就是三个孔。<Set figure="culling" to={{ backs: "painted" }}>给背面涂上颜色</Set>
            找到它们，再一个个翻过来。
          </p>
        </>
      ),
    },
    manifold: {
      title: "什么时候才有内部",
      text: (
        <p>
          如果每条边都恰好有两个三角形，每个顶点周围的三角形又绕成一圈，网格就是封闭的<Term id="manifold">流形</Term>。内外因此分明，细分、布尔运算、物理模拟才做得成。有孔就不行；
          <Term id="t-junction">T 形接点</Term>也不行：一个三角形的顶点落在别人的边上，那条边却没有它。两个网格静静摆着可以一模一样，一打光、一剔除、一切割，就见了分晓。挑一个病人看看：每种毛病都有名字，也有治法。
        </p>
      ),
    },
    bernstein: {
      title: "四个点，一条曲线",
      text: (
        <>
          <p>
            没有人一个三角形一个三角形地捏茶壶。作者摆的是<Term id="control-point">控制点</Term>：一片曲面十六个，一条曲线四个，这样的曲线叫<Term id="bezier">三次贝塞尔曲线</Term>。图中这四个点，画出壶嘴的下沿。曲线在 t 处的点，是四个控制点按
            <Term id="bernstein">伯恩斯坦</Term>权重的混合：
          </p>
          <Formula>
            (1 − t)³ P₀ + 3t(1 − t)² P₁ + 3t²(1 − t) P₂ + t³ P₃
          </Formula>
          <p>
            t 从 0 到 1，权重都不为负，和为一，所以曲线走不出控制点的<Term id="convex-hull">凸包</Term>。它从 P₀ 朝着 P₁ 出发，从 P₂ 的方向到达 P₃。圆点的大小，表示 t ={" "}
            <Handle figure="bernstein" field="t" value={0.35} low={-0.1} high={1.1} step={0.05} name="t" /> 时每个点的分量。让 t 超过 1 试试：有个权重变负，曲线就跑出去了。
          </p>
          <p>
            <Term id="de-casteljau">德卡斯特里奥算法</Term>连权重都不用：相邻两点取中间，四个变三个，三个变两个，最后剩一个。曲线上的点、切线、左右两段的控制点，一并到手。
          </p>
        </>
      ),
    },
    runge: {
      title: "为什么不用一个高次多项式",
      text: (
        <p>
          过十一个点，恰好有一个不超过十次的多项式。每个点它都经过，两点之间却可能振荡到很远，这就是<Term id="runge">龙格现象</Term>。
        </p>
      ),
      after: (
        <p>
          换成一段段首尾相接的三次曲线，也就是<Term id="spline">样条</Term>，你动哪个点，弯的就是哪一带，远处几乎不动。把中间的点抬到{" "}
          <Handle figure="runge" field="lift" value={0.15} low={-1.5} high={1.5} step={0.05} name="中间点的高度" />，比一比这两条。
        </p>
      ),
    },
    spline: {
      title: "许多段低次曲线",
      text: <p>次数低，每一段都安稳；段数多，控制就是局部的：一个控制点只影响一段，不会牵动全线。于是问题落到了段与段相接的地方。</p>,
    },
    joins: {
      title: "接得好不好",
      text: (
        <p>
          <Term id="continuity">C0</Term>：这段的终点是那段的起点，可能有折角。C1：方向和速度也一致。C2：弯曲也一致。C1 与 C2 的区别，单看线条未必看得出，看
          <Set figure="joins" to={{ keep: "C1" }}>反射的条纹</Set>就清楚了：<Term id="curvature">曲率</Term>在哪里突变，条纹就在哪里折。保持 <Set figure="joins" to={{ keep: "C2" }}>C2</Set>，条纹就连续通过。
        </p>
      ),
    },
    ride: {
      title: "坐上去走一趟",
      text: <p>镜头沿 C1 的路径走，不会跳，但会顿：弯曲突然变了，侧向的推力也就突然变了。过山车、刀具、飞行镜头，要的都是 C2。</p>,
    },
    patch: {
      title: "从曲线到曲面",
      text: (
        <p>
          让曲线的四个点各自沿着一条曲线走，整条曲线就扫出一片曲面：<Term id="tensor-product">张量积</Term>曲面片，4 × 4 个控制点。图中这一片是半个壶嘴，前面那条曲线就是它的一条边。这只茶壶是马丁·纽维尔（Martin Newell）1975 年画的，由{" "}
          {say.whole(facts.teapot.patches)} 片拼成：{say.bytes(facts.teapot.bytes)}的文本，放多大都是光滑的。
        </p>
      ),
    },
    cage: {
      title: "或者，把控制网格磨圆",
      text: (
        <p>
          美术师更爱推拉一个由四边形组成的粗网格，叫<Term id="cage">控制网格</Term>。Catmull–Clark <Term id="subdivision">细分</Term>把每个四边形分成四个，再取平均：分{" "}
          <Handle figure="cage" field="level" value={2} low={0} high={5} name="细分次数" />{" "}
          次，就已经很难和光滑的极限曲面区分了。每细分一次，面数变为四倍，误差约剩四分之一。不管是曲面片还是控制网格，到最后一刻，全都变成三角形。
        </p>
      ),
    },
    pull: {
      title: "拉一拉控制网格",
      text: <p>拖动控制网格的一个顶点，曲面跟着动：最近处动得最多，这里是它移动距离的 {say.number(facts.pull)} 倍；两圈面以外一点不动，不过立方体一共也就两圈。</p>,
    },
    segments: {
      title: "多少段看起来才光滑？",
      text: (
        <p>
          把光滑的形状变成一段段直的，叫做<Term id="tessellation">曲面细分</Term>；放到平面上，问题就成了这样：曲线上两点之间连一条<Term id="chord">弦</Term>
          ，曲线离弦最远有多远，就是弦高误差；小于半个像素，谁也看不见。把这条曲线按参数等分：
        </p>
      ),
      after: (
        <p>
          误差按 1/N² 下降：8 段 {say.number(facts.segments.gaps.get(8)!)} 像素，16 段 {say.number(facts.segments.gaps.get(16)!)}，32 段{" "}
          {say.number(facts.segments.gaps.get(32)!)}。开头收获很大，越往后越小。现在是{" "}
          <Handle figure="segments" field="count" value={6} low={1} high={64} name="线段数" /> 段。要证明两点之间处处都不超过半个像素，等分需要{" "}
          {say.whole(facts.segments.evenly)} 段；<Set figure="segments" to={{ how: "fewest" }}>弯处加密</Set>，只要 {say.whole(facts.segments.fewest)} 段。
        </p>
      ),
    },
    cracks: {
      title: "公共边只分一次",
      text: <p>两片曲面共用一条边，就得在同样的点上分。各分各的段数，三角形便对不上，缝里透光；原来的曲面再光滑也没用。</p>,
    },
    field: {
      title: "每个点一个数",
      text: (
        <>
          <p>
            从头再来，这次用规则。给空间中每个点一个数：它到形状的距离，里面取负。这叫<Term id="signed-distance">有向距离</Term>。一个球，一行就写完：
          </p>
          <Formula>f(p) = |p| − r</Formula>
          <p>
            在不在里面，看一个符号。法线是归一化的<Term id="gradient">梯度</Term>，在近旁取几个样本就有。拖动那个点：以场的值为半径画圆，圆从不越过形状的边界。拿同样的问题
            <Set figure="field" to={{ asked: "mesh" }}>去问网格</Set>，它得把 {say.whole(facts.field.edges)} 条边找一遍。
          </p>
        </>
      ),
    },
    tracing: {
      title: "跳着走的射线",
      text: (
        <p>
          画一个场，要从每个像素射出一条射线。一次能走多远？场的值是多少，就走多远，因为这个范围内什么都没有。这叫<Term id="sphere-tracing">球面追踪</Term>。
        </p>
      ),
      after: (
        <p>
          空旷处一步跨出老远，贴着表面就只能慢慢蹭：这幅画里最慢的一条要走 {say.whole(facts.tracing.most)} 步。跟着你的这条走{" "}
          <Handle figure="tracing" field="shown" value={4} low={0} high={40} name="显示的步数" /> 步。
        </p>
      ),
    },
    csg: {
      title: "一行打一个孔",
      text: (
        <p>
          并集是 min(a, b)，交集是 max(a, b)，减去则是 max(a, −b)。这就是<Term id="csg">构造实体几何</Term>
          ：给方块打个孔，一行，每处的符号都对。只是值不再处处是距离，成了距离的下界；所以射线照样不会跨过头。
        </p>
      ),
    },
    blend: {
      title: "把接缝磨圆",
      text: <p>取最小时，换一种会把尖角磨圆的取法，两个形状就在相接处流到一起，圆多圆少随你定。在网格上倒一个圆角是一项工程；在这里，还是那一行。</p>,
    },
    booleans: {
      title: "换成三角形来打",
      text: <p>用两个网格打同一个孔，就琐碎了。相交的三角形要两两切开，舍入会挪动交点，三个面几乎交于一点的地方，粗心的代码就留下裂缝。精确的做法是有的，但绝不止一行。</p>,
    },
    squares: {
      title: "回到三角形",
      text: (
        <p>
          硬件只画三角形，场也得变过去。先在格点上采样；再看每个单元的顶点哪些在里面，两端不同的边上放一个顶点，再连起来：这就是<Term id="marching-cubes">移动立方体</Term>
          ，平面上叫移动正方形。尖角会被切掉，除非网格化算法知道形状由哪些部分组成，把顶点放到<Set figure="squares" to={{ method: "corners" }}>它们相交的地方</Set>。
        </p>
      ),
    },
    cubes: {
      title: "一个单元一个单元，整张曲面",
      text: <p>到了空间里，一个单元八个顶点，内外共有 256 种情形。单元逐个走完，一张曲面就出来了，而且天生封闭，只要相邻的单元对公共的面读法一致。</p>,
    },
    network: {
      title: "学出来的规则",
      text: (
        <p>
          规则不一定要人来写。三维视觉里，用照片或扫描训练一个小网络，让它说出任意一点有没有<Term id="occupancy">被占据</Term>。想看它学到了什么，就在它上面跑一遍移动立方体。
        </p>
      ),
    },
    baking: {
      title: "一来一回",
      text: (
        <p>
          引擎两种都带着，来回转换。要碰撞、要融合，就把茶壶的 {say.whole(facts.baking.triangles)} 个三角形<Term id="baking">烘焙</Term>
          成格点上的距离，这里是 {say.whole(facts.baking.samples)} 个样本；再网格化回来，成了 {say.whole(facts.baking.back)}{" "}
          个三角形。每一程都有损失，每份损失都有上界。最长边方向只取{" "}
          <Handle figure="baking" field="cells" value={20} low={6} high={36} name="最长边方向的单元数" /> 个单元，看看壶把会变成什么样。
        </p>
      ),
    },
    table: {
      title: "并排比较",
      text: <p>同一个形状，两种写法，逐项量过。谁也没有赢。要画得快，用网格；要雕、要融、要查询，用场。</p>,
    },
    budget: {
      title: "误差减半的代价",
      text: (
        <p>
          三角形越多，离真实的曲面越近，轮廓越圆，明暗越匀；每一个也都要占内存、花时间。误差减半，曲线需{" "}
          {say.fixed(facts.budget.curve, 1)} 倍的段数，曲面需 {facts.budget.surfaces.map((times) => say.fixed(times, 1)).join(" 到 ")} 倍的三角形，不论它写成曲面片、控制网格还是场。所以最初的一千个三角形几乎买下了全部，最后的一百万个几乎什么也没买到。
        </p>
      ),
    },
    overshade: {
      title: "小于像素的悬崖",
      text: (
        <p>
          图形硬件以 2 × 2 的像素块为单位着色，三角形哪怕只占到块里一个像素。大三角形无所谓。可是把边长缩到{" "}
          <Handle figure="overshade" field="stop" value={9} low={0} high={26} name="三角形边长" shown={SIDES.map((side) => `${side} 像素`)} /> 试试。
        </p>
      ),
      after: (
        <p>
          这叫<Term id="overshading">过度着色</Term>。何况这些三角形大多落在像素中心之间，根本看不见：小于一个像素，只有代价，没有收获。
        </p>
      ),
    },
    shimmer: {
      title: "而且会闪",
      text: (
        <p>
          还不止白费：像素中心碰上的是众多小三角形中的哪一个，一帧一变，转动的表面便满是闪点。这叫<Term id="aliasing">走样</Term>：细节比样本还多，显示不过来。
        </p>
      ),
    },
    levels: {
      title: "远近都是一个像素",
      text: (
        <p>
          所以同一个形状要存几个<Term id="lod">细节层次</Term>，每一层的误差都有证明过的上界，单位是长度；再把这个长度换算到真正要紧的地方，<Term id="screen-space">屏幕空间</Term>
          。从 <Handle figure="levels" field="stop" value={0} low={0} high={18} name="镜头到茶壶" shown={DISTANCES.map((distance) => metres(say, distance))} />{" "}
          外看，就显示误差不超过一个像素的最粗的一层。退到 {metres(say, DISTANCES[6]!)} 外，茶壶只有 {say.whole(facts.levels.smallPixels)} 像素宽，{say.whole(facts.levels.small.teapot)} 个三角形就够了。
        </p>
      ),
      after: (
        <p>
          两者的误差都至多一个像素，在屏幕的角上也是；同是一个像素，在茶壶上是 {metres(say, facts.levels.pixel.teapot)}，在山上是{" "}
          {metres(say, facts.levels.pixel.mountain)}。退到 <Set figure="levels" to={{ stop: 4 }}>{metres(say, DISTANCES[4]!)} 外</Set>，茶壶只需{" "}
          {say.whole(facts.levels.far.teapot)} 个三角形，山毫无变化。
        </p>
      ),
    },
    adaptive: {
      title: "看得出的地方才加密",
      text: (
        <p>
          同一层里也不必处处一样密。曲面弯的地方、离镜头近的地方、<Term id="silhouette">轮廓线</Term>
          上，三角形要挤一些：直边衬着背景最显眼。平的、远的，少放几个就行。轮廓线上，每条弦的误差都在预算以内，这里是{" "}
          <Handle figure="adaptive" field="stop" value={4} low={0} high={6} name="预算" shown={BUDGETS.map((px) => `${say.number(px)} 像素`)} />
          ；正对着你的面，误差顺着视线，大一些也无妨。
        </p>
      ),
    },
    mountain: {
      title: "按真实大小",
      text: <p>把两者放进同一幅画，误差都在 {say.number(facts.mountain.pixels)} 个像素以内。沿着边移动放大镜：灰色是真实的曲面，蓝色是三角形，一格一个像素；两者哪里都不会离得更远。{metres(say, facts.mountain.distance)} 外的茶壶要 {say.whole(facts.mountain.teapot)} 个三角形；这座山的山脊比前一座更多，要 {say.whole(facts.mountain.mountain)} 个。</p>,
    },
  }),
  table: ({ rivals }, say) => (
    <table class="rivals">
      <caption>一个宽 2 的方块，中间打一个孔。网格的误差至多 {say.number(rivals.bound)}，已证明。</caption>
      <thead>
        <tr>
          <td />
          <th scope="col">网格：点的清单</th>
          <th scope="col">场：一条规则</th>
        </tr>
      </thead>
      <tbody>
        <tr>
          <th scope="row">形状是什么</th>
          <td>
            {say.whole(rivals.triangles)} 个三角形，{say.bytes(rivals.bytes)}
          </td>
          <td>max(方块, −孔)：{say.whole(rivals.operations)} 步运算</td>
        </tr>
        <tr>
          <th scope="row">绘制</th>
          <td>拿来就画，每个三角形画一次</td>
          <td>
            一条射线平均 {say.fixed(rivals.steps, 1)} 步，最多 {say.whole(rivals.most_steps)} 步；要么先网格化
          </td>
        </tr>
        <tr>
          <th scope="row">判定内外</th>
          <td>要搜索：最多查遍 {say.whole(rivals.triangles)} 个三角形</td>
          <td>一个值，一个符号</td>
        </tr>
        <tr>
          <th scope="row">布尔运算</th>
          <td>
            {say.whole(rivals.operands[0])} × {say.whole(rivals.operands[1])} = {say.whole(rivals.pairs)} 对三角形，都可能互相切开
          </td>
          <td>取一次最大，一行</td>
        </tr>
        <tr>
          <th scope="row">法线</th>
          <td>存下来，共 {say.whole(rivals.normals)} 条</td>
          <td>取梯度：附近几个样本</td>
        </tr>
      </tbody>
    </table>
  ),
  guesses: (facts, say) => ({
    plane: {
      ask: "正方形的一个角抬起来了。中间往哪边鼓？",
      options: { up: "往上", down: "往下", both: "都有可能" },
      answer: (
        <>
          要看对角线怎么连。连这一条，中间是脊；连那一条，中间是谷；四个顶点自己并没有说。现在 D 离另外三点的平面 {say.number(facts.bulge)}。
        </>
      ),
    },
    indexed: {
      ask: "平均来说，一个顶点由几个三角形共用？",
      unit: "个",
      answer: (
        <>
          这里是 {say.number(facts.indexed.triangles_per_vertex)} 个。封闭的大网格都接近六个：顶点数约是三角形数的一半，而每个三角形用到三个顶点。
        </>
      ),
    },
    normals: {
      ask: "立方体有 8 个角。在游戏里，它有多少个顶点？",
      options: { "8": "8", "24": "24", "36": "36" },
      answer: (
        <>
          {say.whole(facts.cube.hard)} 个：每个角上有三个面相遇，各要一个顶点，各带自己的法线。法线若取平均，{say.whole(facts.cube.soft)} 个就够，只是看起来像块肥皂。
        </>
      ),
    },
    runge: {
      ask: "十一个点，动了中间那个。多项式有多少会跟着动？",
      options: { near: "只有附近", half: "大约一半", everywhere: "处处都动" },
      answer: <>处处都动，动得最厉害的可能反而在两端。对一个多项式来说没有“附近”：每个系数都取决于所有的点。</>,
    },
    segments: {
      ask: "参数等分成多少段，误差才在半个像素以内？",
      unit: "段",
      answer: <>{say.whole(facts.segments.seen)} 段。再多一千段，看起来也一样。</>,
    },
    tracing: {
      ask: "图中的射线，几步走到表面？",
      unit: "步",
      answer: <>{say.whole(facts.tracing.steps)} 步。最后几步最短，因为离表面越近，值越小。</>,
    },
    overshade: {
      ask: `边长只有 ${SIDES.at(-1)} 像素的三角形铺满屏幕。每个像素要着色几次？`,
      unit: "次",
      answer: (
        <>
          {say.number(facts.overshade.below)} 次：每个像素都要陪上一整个 2 × 2 的块。边长 {SIDES[0]} 像素时，是 {say.number(facts.overshade.above)} 次。
        </>
      ),
    },
    levels: {
      ask: `茶壶在 ${metres(say, DISTANCES[0]!)} 外，山在它后面 ${metres(say, facts.levels.behind)}。谁需要的三角形更多？`,
      options: { teapot: "茶壶", same: "差不多", mountain: "山" },
      answer: (
        <>
          茶壶：{say.whole(facts.levels.near.teapot)} 个，山只要 {say.whole(facts.levels.near.mountain)} 个，尽管山的宽度是茶壶的 {say.whole(facts.levels.wider)} 倍。
        </>
      ),
    },
  }),
  terms: {
    explicit: { word: "显式", formula: <>点 p₀, p₁, p₂, … 以及谁与谁相连</>, gloss: "列出点和它们的连接来表示形状。拿来就能画。" },
    implicit: { word: "隐式", formula: <>形状就是 f(p) = 0 之处</>, gloss: "用一条可以在任意点求值的规则来表示形状。判定内外一问便知，要画则须搜索。" },
    planar: { word: "平（共面）", formula: <>n · (p − a) = 0</>, gloss: "整个落在一个平面里。不共线的三点恰好定一个平面。" },
    normal: { word: "法线", formula: <>对平面上任意 p：n · (p − a) = 0，|n| = 1</>, gloss: "垂直于表面的单位向量，光照由它算出。" },
    convex: { word: "凸", gloss: "任取其中两点，连线都不会跑出去。三角形总是凸的，多边形则不一定。" },
    "edge-function": { word: "边函数", formula: <>E(p) = (b − a) × (p − a)</>, gloss: "a、b、p 构成的三角形有向面积的两倍；p 在从 a 到 b 的边左侧时为正。" },
    rasterization: { word: "光栅化", gloss: "在像素中心求三个边函数的值，定出三角形覆盖哪些像素。" },
    barycentric: { word: "重心坐标", formula: <>p = w₀a + w₁b + w₂c, w₀ + w₁ + w₂ = 1</>, gloss: "把一个点写成三个顶点的混合，写法唯一。在内部，三个权重都为正。" },
    uv: { word: "UV 坐标", gloss: "每个顶点上的两个数，说明那里对应图片的哪个位置。" },
    tangent: { word: "切线", formula: <>T = ∂p/∂u</>, gloss: "v 不变、u 增长时，面上的点朝哪里移动。在平的三角形上处处相同。" },
    triangulation: { word: "三角剖分", formula: <>n 个顶点，n − 2 个三角形</>, gloss: "用对角线把多边形分成三角形。简单多边形总能这样分。" },
    mesh: { word: "网格", formula: <>顶点，以及顶点之间的三角形</>, gloss: "由三角形拼成的曲面，三角形之间共用顶点和边。" },
    "vertex-buffer": { word: "顶点缓冲", formula: <>12 字节：x、y、z，各 32 位浮点数</>, gloss: "顶点的清单，每个顶点连同它的属性只存一次。" },
    "index-buffer": { word: "索引缓冲", formula: <>6 字节：三个 16 位整数</>, gloss: "每个三角形记三个顶点的编号。顶点超过 65,536 个时，每个编号要 32 位。" },
    "cross-product": {
      word: "叉积",
      formula: (
        <>
          (a<sub>y</sub>b<sub>z</sub> − a<sub>z</sub>b<sub>y</sub>, a<sub>z</sub>b<sub>x</sub> − a<sub>x</sub>b<sub>z</sub>, a<sub>x</sub>b<sub>y</sub> − a<sub>y</sub>b<sub>x</sub>)
        </>
      ),
      gloss: "同时垂直于 a 和 b 的向量，长度等于它们张成的平行四边形的面积。两者对调，方向相反。",
    },
    shading: { word: "平直着色与平滑着色", gloss: "前者每个面一条法线；后者每个顶点一条，在面内插值。" },
    winding: { word: "环绕方向", gloss: "三角形三个顶点的次序。约定从正面看是逆时针。" },
    culling: { word: "背面剔除", formula: <>n · (eye − p) &lt; 0 则跳过</>, gloss: "不画背对视点的三角形；形状封闭时，它们总被挡住。" },
    manifold: { word: "流形", formula: <>每条边：两个三角形</>, gloss: "任何一点附近看起来都像一个圆盘。再加上封闭，就有了内部。" },
    "t-junction": { word: "T 形接点", gloss: "顶点落在邻居的边上，而邻居没有这个顶点。舍入误差会在那里撕开一道缝。" },
    "control-point": { word: "控制点", gloss: "牵引曲线或曲面的点，一般不在曲线曲面上。" },
    bezier: {
      word: "三次贝塞尔曲线",
      formula: (
        <>
          Σ B<sub>i</sub>(t) P<sub>i</sub>，i = 0 … 3
        </>
      ),
      gloss: "由四个点决定的曲线：两个端点，另外两个管它出发和到达的方向。",
    },
    bernstein: {
      word: "伯恩斯坦多项式",
      formula: (
        <>
          B<sub>i</sub>(t) = C(3, i) t<sup>i</sup> (1 − t)<sup>3−i</sup>
        </>
      ),
      gloss: "贝塞尔曲线各控制点的权重：t 从 0 到 1 时都不为负，和为 1。",
    },
    "convex-hull": { word: "凸包", gloss: "包住若干点的最小凸形：拿橡皮筋一套，围住的就是。" },
    "de-casteljau": { word: "德卡斯特里奥算法", formula: <>lerp(p, q, t) = (1 − t)p + tq：4 → 3 → 2 → 1</>, gloss: "相邻两点反复插值，直到只剩一个点，即曲线上的点。" },
    runge: { word: "龙格现象", gloss: "多项式穿过等距的点，点越多，两端的振荡可能越大。" },
    spline: { word: "样条", gloss: "由许多低次曲线段平滑相接而成的曲线。" },
    continuity: { word: "C0、C1、C2", formula: <>值相等；一阶导数也相等；二阶导数也相等</>, gloss: "两段接得有多平滑：位置，方向与速度，弯曲。" },
    curvature: { word: "曲率", formula: <>κ = |c′ × c″| / |c′|³</>, gloss: "沿曲线走，方向转得有多快：等于最贴合的那个圆的半径的倒数。" },
    "tensor-product": {
      word: "张量积",
      formula: (
        <>
          Σ B<sub>i</sub>(u) B<sub>j</sub>(v) P<sub>ij</sub>
        </>
      ),
      gloss: "权重是两条曲线权重之积的曲面。双三次曲面片有 4 × 4 个控制点。",
    },
    cage: { word: "控制网格", gloss: "粗糙的网格，多由四边形组成；光滑的曲面跟着它走，但不碰到它。" },
    subdivision: { word: "细分曲面", formula: <>每次面数 × 4</>, gloss: "把控制网格的面一分再分、顶点反复取平均，所趋近的极限。" },
    tessellation: { word: "曲面细分（tessellation）", gloss: "把光滑的形状变成三角形，或把曲线变成线段。也译作镶嵌；与细分曲面是两回事。" },
    chord: { word: "弦", formula: <>弦高误差 ≤ max|c″| h² / 8</>, gloss: "曲线上两点间的直线段。步长 h 减半，弦高误差剩四分之一。" },
    "signed-distance": { word: "有向距离", formula: <>球：f(p) = |p| − r</>, gloss: "到表面最近点的距离，内部取负。" },
    gradient: { word: "梯度", formula: <>∇f = (∂f/∂x, ∂f/∂y, ∂f/∂z)</>, gloss: "场增长最快的方向。距离场的梯度长度为 1，在表面上就是法线。" },
    "sphere-tracing": { word: "球面追踪", formula: <>t ← t + f(eye + t · way)</>, gloss: "沿射线前进，每步的长度由场保证安全。" },
    csg: { word: "构造实体几何（CSG）", formula: <>min(a, b), max(a, b), max(a, −b)</>, gloss: "用简单实体的并、交、差造出复杂的实体。" },
    "marching-cubes": { word: "移动立方体", formula: <>2⁸ = 256 种情形</>, gloss: "由场的样本得到三角形：一次一个单元，看各个顶点的符号。" },
    occupancy: { word: "占据", formula: <>o(p) ∈ [0, 1]，表面在 ½ 处</>, gloss: "有多大把握说一点在里面；视觉网络学的就是它。" },
    baking: { word: "烘焙", gloss: "把场的值一次算好，存到格点上。" },
    overshading: { word: "过度着色", formula: <>着色的像素数 ÷ 覆盖的像素数</>, gloss: "硬件按 2 × 2 的块着色，三角形没有覆盖到的像素也白白算了一遍。" },
    aliasing: { word: "走样", gloss: "细节比采样还密，显出来就成了虚假的、闪动的粗花纹。" },
    lod: { word: "细节层次（LOD）", gloss: "同一个形状，三角形更少，供更远处使用。" },
    "screen-space": { word: "屏幕空间误差", formula: <>像素 ≈ 长度 ÷ 距离 × 高度 ÷ (2 tan(fov/2))</>, gloss: "眼睛看到的误差：它的长度在那个距离上占多少像素。" },
    silhouette: { word: "轮廓线", formula: <>n · (eye − p) = 0 之处</>, gloss: "曲面由正面转到背面的地方。三角形太粗，最先在这里露馅。" },
  },
  questions: {
    title: "六个问题",
    lead: "先用自己的话写下回答，再翻开卡片。每张背后都有一个数字，和一幅可以核对的图。",
    cards: (facts, say) => ({
      triangles: {
        ask: "为什么是三角形？",
        answer: (
          <>
            三点必共面，围成的必是凸的，顶点上的东西只有一种混法。第四点可以离开平面，这里离开了 {say.number(facts.bulge)}；这时面是什么样，取决于一条没人存下来的对角线。
          </>
        ),
        figure: "plane",
      },
      normals: {
        ask: "面的法线怎么算？平直与平滑的着色，差在哪里？",
        answer: (
          <>
            两条边的叉积，缩放到长度一。每个面一条，就是平直的；在顶点处取平均，就是平滑的。硬棱两边各留一条，所以立方体有 {say.whole(facts.cube.hard)} 个顶点。
          </>
        ),
        figure: "normals",
      },
      winding: {
        ask: "环绕方向记下了什么？背面剔除为什么离不开它？",
        answer: (
          <>
            记下哪一面是正面：从那边看，三个顶点是逆时针的。剔除跳过背对视点的三角形，这个球上有 {say.percent(facts.culling.back_share)}；它只认次序，绕反一个，就是一个孔。
          </>
        ),
        figure: "winding",
      },
      joins: {
        ask: "C0、C1、C2 是什么？为什么要许多段低次曲线？",
        answer: (
          <>C0：两段相接；C1：方向和速度也一致；C2：弯曲也一致，镜头路径要它；反射只需曲率相等（G2）。许多短的低次曲线安稳，互不牵连：十一个点中的一个抬高 {say.number(facts.runge.lift)}，相邻两点以外，样条最多动{" "}
            {say.number(facts.runge.spline)}，一个多项式动 {say.number(facts.runge.polynomial)}。</>
        ),
        figure: "joins",
      },
      fields: {
        ask: "网格和场，各自擅长什么，不擅长什么？",
        answer: (
          <>
            网格马上能画；判定内外、做布尔运算都要搜索。场判定内外、求距离、做布尔运算都只要一行；要画，则一条射线平均走 {say.fixed(facts.rivals.steps, 1)}{" "}
            步，或者先变成网格。引擎两种都用，来回转换。
          </>
        ),
        figure: "table",
      },
      cost: {
        ask: "三角形越多越好吗？",
        answer: (
          <>
            是，直到每条弦的误差都在一个像素以内。再多也显示不出新东西；小于一个像素时，每个像素要着色 {say.number(facts.overshade.below)} 次，还会闪。
          </>
        ),
        figure: "overshade",
      },
    }),
  },
  ending: {
    title: "预算花在看得见的地方；眼睛分不出了，就停。",
    text: <>Chordal 替你自己的形状做的就是这件事：你说能看出多少误差，它给出三角形，并证明误差不超过多少。</>,
  },
};
