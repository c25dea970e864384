//! The dynamics against closed forms, and against themselves.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Point3, Unit, Vector3};
use proptest::prelude::*;
use quell_rigid_body::Dynamics;
use quell_signal::{Body, JointKind, Tree, TreeJoint};

const G: f64 = 9.81;

fn joint(
    parent: Option<usize>,
    before: Isometry3<f64>,
    axis: Vector3<f64>,
    kind: JointKind,
) -> TreeJoint {
    TreeJoint {
        name: "joint".into(),
        parent,
        before,
        axis: Unit::new_normalize(axis),
        kind,
        damping: 0.0,
        friction: 0.0,
    }
}

/// `[[m_11, m_12], [m_12, m_22]] q'' + h + g` of two links in a vertical plane, as in textbooks.
///
/// Source: Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006), section 7.3.2.
#[test]
fn val_two_links_in_a_plane() {
    let (l1, c1, c2) = (0.4, 0.25, 0.2);
    let (m1, m2, i1, i2) = (3.0, 2.0, 0.05, 0.03);
    // In the plane x, y with gravity along -y, so that the axes are z.
    let bodies = [(m1, c1, i1), (m2, c2, i2)].into_iter().enumerate();
    let bodies = bodies.map(|(joint, (mass, centre, inertia))| Body {
        joint,
        mass,
        centre: Point3::new(centre, 0.0, 0.0),
        inertia: Matrix3::identity() * inertia,
    });
    let elbow = Isometry3::translation(l1, 0.0, 0.0);
    let tree = Tree {
        joints: vec![
            joint(
                None,
                Isometry3::identity(),
                Vector3::z(),
                JointKind::Revolute,
            ),
            joint(Some(0), elbow, Vector3::z(), JointKind::Revolute),
        ],
        bodies: bodies.collect(),
    };
    let arm = Dynamics::new(&tree, Vector3::new(0.0, -G, 0.0));
    let (q, v, a) = ([0.3, -0.8], [1.1, -2.3], [4.0, 0.7]);
    let (cos, sin) = (f64::cos(q[1]), f64::sin(q[1]));
    let m11 = m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2.0 * l1 * c2 * cos) + i1 + i2;
    let m12 = m2 * (c2 * c2 + l1 * c2 * cos) + i2;
    let m22 = m2 * c2 * c2 + i2;
    let h = -m2 * l1 * c2 * sin;
    let g2 = m2 * c2 * G * f64::cos(q[0] + q[1]);
    let g1 = (m1 * c1 + m2 * l1) * G * f64::cos(q[0]) + g2;
    let expected = [
        m11 * a[0] + m12 * a[1] + h * v[1] * (2.0 * v[0] + v[1]) + g1,
        m12 * a[0] + m22 * a[1] - h * v[0] * v[0] + g2,
    ];
    let found = arm.torques(&q, &v, &a);
    let inertias = arm.inertias(&q);
    for k in 0..2 {
        assert!((found[k] - expected[k]).abs() < 1e-13 * expected[k].abs().max(1.0));
    }
    assert!((inertias[0] - m11).abs() < 1e-14 && (inertias[1] - m22).abs() < 1e-14);
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(Vector3::from)
}

/// A joint with a body, behind one of those before it.
#[derive(Clone, Debug)]
struct Link {
    /// From the link before, and how it is turned there.
    placed: [Vector3<f64>; 2],
    axis: Vector3<f64>,
    centre: Vector3<f64>,
    slides: bool,
    mass: f64,
    parent: usize,
}

fn link() -> impl Strategy<Value = Link> {
    let axis = vector().prop_filter("a length", |axis| axis.norm() > 0.1);
    let placed = prop::array::uniform2(vector());
    let slides = prop::bool::weighted(0.3);
    let all = (placed, axis, vector(), slides, 0.1..3.0f64, 0..100usize);
    all.prop_map(|(placed, axis, centre, slides, mass, parent)| Link {
        placed,
        axis,
        centre,
        slides,
        mass,
        parent,
    })
}

fn tree(links: &[Link]) -> Tree {
    let mut tree = Tree {
        joints: Vec::new(),
        bodies: Vec::new(),
    };
    for (k, link) in links.iter().enumerate() {
        let kind = match link.slides {
            true => JointKind::Prismatic,
            false => JointKind::Revolute,
        };
        let [shift, turn] = link.placed;
        let parent = (k > 0).then(|| link.parent % k.max(1));
        let before = Isometry3::new(shift, turn);
        tree.joints.push(joint(parent, before, link.axis, kind));
        let turned = nalgebra::Rotation3::new(turn);
        let own = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04));
        tree.bodies.push(Body {
            joint: k,
            mass: link.mass,
            centre: Point3::from(link.centre),
            inertia: turned * own * turned.transpose(),
        });
    }
    tree
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Without gravity and torques the kinetic energy `q' M q' / 2` stays: its rate is `q' (tau - tau(q, q', 0)) + q' M' q' / 2`.
    #[test]
    fn energy_stays(
        links in prop::collection::vec(link(), 1..6),
        values in prop::collection::vec(-2.0..2.0f64, 10),
    ) {
        let n = links.len();
        let tree = tree(&links);
        let (q, v) = (&values[..n], &values[5..5 + n]);
        let floating = Dynamics::new(&tree, Vector3::zeros());
        let mass = |q: &[f64]| {
            let still = vec![0.0; n];
            let column = |k: usize| {
                let mut unit = vec![0.0; n];
                unit[k] = 1.0;
                DVector::from_vec(floating.torques(q, &still, &unit))
            };
            DMatrix::from_columns(&(0..n).map(column).collect::<Vec<_>>())
        };
        let own = mass(q);
        // The recursion over bodies and that over composites are one matrix, which is symmetric.
        let seen = floating.inertias(q);
        for k in 0..n {
            prop_assert!((own[(k, k)] - seen[k]).abs() < 1e-10 * (1.0 + seen[k]));
        }
        prop_assert!((&own - own.transpose()).norm() < 1e-10 * (1.0 + own.norm()));
        // q' M' q' / 2 = q' c for the Coriolis forces c: they do no work.
        let h = 1e-5;
        let moved = |sign: f64| -> Vec<f64> { q.iter().zip(v).map(|(q, v)| q + sign * h * v).collect() };
        let rate = (mass(&moved(1.0)) - mass(&moved(-1.0))) / (2.0 * h);
        let speed = DVector::from_column_slice(v);
        let work = speed.dot(&DVector::from_vec(floating.torques(q, v, &vec![0.0; n])));
        let changed = 0.5 * speed.dot(&(&rate * &speed));
        prop_assert!((work - changed).abs() < 1e-6 * (1.0 + own.norm()), "{work} {changed}");
    }
}
