//! Mapping against closed forms: constants, linear fields, tensors, order of convergence, borders,
//! weld lines, hems, and the way there and back.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use shapematch::geometry::tensor::{Tensor, principal, rotated, von_mises};
use shapematch::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3};
use shapematch::mapping::*;
use shapematch::monitor::{Monitor, Observer};

/// Where a point (u, v) of the flat blank lies.
pub(super) type Shape = fn(f64, f64) -> Point3;

pub(super) fn flat(u: f64, v: f64) -> Point3 {
    Point3::new(u, v, 0.0)
}

/// A cylinder of radius 20 about the x axis.
pub(super) fn cylinder(u: f64, v: f64) -> Point3 {
    let angle = v / 20.0;
    Point3::new(u, 20.0 * angle.sin(), 20.0 * angle.cos())
}

/// Quads of about `size` over a blank of `length` × `width`, turned by `turn` in the blank and with
/// inner nodes moved by a fifth of their size.
pub(super) struct Blank {
    pub length: f64,
    pub width: f64,
    pub size: f64,
    pub jitter: f64,
}

impl Blank {
    pub fn new(size: f64) -> Self {
        Self {
            length: 100.0,
            width: 60.0,
            size,
            jitter: 0.2,
        }
    }

    pub fn mesh(&self, shape: Shape) -> ShellMesh {
        let nu = (self.length / self.size).round() as u32;
        let nv = (self.width / self.size).round() as u32;
        let mut positions = Vec::new();
        for i in 0..=nu {
            for j in 0..=nv {
                let hash = |k: f64| {
                    let x = (f64::from(i) * 12.9898 + f64::from(j) * 78.233 + k).sin() * 43758.5453;
                    x - x.floor() - 0.5
                };
                let is_inner = i > 0 && j > 0 && i < nu && j < nv;
                let wobble = if is_inner {
                    2.0 * self.jitter * self.size
                } else {
                    0.0
                };
                let u = self.length * f64::from(i) / f64::from(nu) + wobble * hash(0.1);
                let v = self.width * f64::from(j) / f64::from(nv) + wobble * hash(7.7);
                positions.push(shape(u, v));
            }
        }
        let node = |i: u32, j: u32| i * (nv + 1) + j;
        let mut corners = Vec::new();
        for i in 0..nu {
            for j in 0..nv {
                corners.push([
                    node(i, j),
                    node(i + 1, j),
                    node(i + 1, j + 1),
                    node(i, j + 1),
                ]);
            }
        }
        let parts = vec![0; corners.len()];
        ShellMesh::new(positions, corners, parts).unwrap()
    }
}

/// The mesh with every element reversed.
fn flipped(mesh: &ShellMesh) -> ShellMesh {
    let corners = mesh
        .corners()
        .iter()
        .map(|&[a, b, c, d]| [a, d, c, b])
        .collect();
    ShellMesh::new(mesh.positions().to_vec(), corners, mesh.parts().to_vec()).unwrap()
}

/// A mesh whose elements are all cut into triangles.
fn cut(mesh: &ShellMesh) -> ShellMesh {
    let halves = mesh
        .corners()
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c, c], [a, c, d, d]]);
    let corners: Vec<[u32; 4]> = halves.collect();
    let parts = vec![0; corners.len()];
    ShellMesh::new(mesh.positions().to_vec(), corners, parts).unwrap()
}

/// Forming results given by functions of the centroid.
pub(super) fn source(
    mesh: ShellMesh,
    n_layers: usize,
    state: impl Fn(usize, f64, &ShellMesh) -> [f64; 7],
) -> SourcePart {
    let rule = LayerRule::new(RuleKind::Gauss, n_layers);
    let mut states = Layered::new(mesh.len());
    let mut strains = Layered::new(mesh.len());
    for element in 0..mesh.len() {
        let places = rule.places().iter();
        states.set(element, places.map(|&t| (t, state(element, t, &mesh))));
        let surfaces = [-1.0, 1.0].into_iter();
        strains.set(
            element,
            surfaces.map(|t| {
                (
                    t,
                    std::array::from_fn(|i| 1e-3 * state(element, t, &mesh)[i]),
                )
            }),
        );
    }
    SourcePart {
        thickness: vec![[1.0; 4]; mesh.len()],
        states,
        strains,
        history: SourceHistory::default(),
        laws: BTreeMap::new(),
        mesh,
    }
}

pub(super) fn full() -> MapOptions {
    MapOptions {
        quantities: Quantities::FULL,
        ..MapOptions::default()
    }
}

pub(super) fn map_one(
    part: &SourcePart,
    pose: Similarity,
    target: &TargetPart,
    options: &MapOptions,
) -> Mapped {
    let placed = PlacedSource {
        part,
        target_from_source: pose,
    };
    map(&[placed], target, options, &Monitor::silent()).unwrap()
}

pub(super) fn target(mesh: ShellMesh, n_layers: usize) -> TargetPart {
    TargetPart::uniform(mesh, LayerRule::new(RuleKind::Gauss, n_layers), 1.0)
}

fn some_pose() -> Similarity {
    let rotation = Rotation::from_euler_angles(0.7, -1.2, 2.1);
    Similarity {
        rotation: *rotation.to_rotation_matrix().matrix(),
        translation: Vector3::new(850.0, -40.0, 1200.0),
        scale: 1.0,
    }
}

const STRESS: Tensor = [120.0, -35.0, 0.0, 22.0, 0.0, 0.0];

/// A stress in the plane of the blank, and a plastic strain.
fn uniform(_: usize, _: f64, _: &ShellMesh) -> [f64; 7] {
    [STRESS[0], STRESS[1], 0.0, STRESS[3], 0.0, 0.0, 0.05]
}

fn assert_tensor(found: &[f64], expected: &Tensor, tolerance: f64) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{found:?} against {expected:?}");
    }
}

#[test]
fn constants_and_uniform_tensors_come_through_any_motion_mirror_and_flip() {
    let fine = Blank::new(2.5).mesh(flat);
    let coarse = Blank::new(5.0).mesh(flat);
    let part = source(fine, 5, uniform);
    let mirror = Similarity::mirror_x();
    for pose in [
        Similarity::identity(),
        some_pose(),
        some_pose().after(&mirror),
    ] {
        let moved = coarse.moved(&pose);
        // As a deck would hold it: normals follow from the corners.
        let moved = ShellMesh::new(
            moved.positions().to_vec(),
            moved.corners().to_vec(),
            moved.parts().to_vec(),
        )
        .unwrap();
        for mesh in [moved.clone(), flipped(&moved), cut(&moved)] {
            for n_plane in [1, 4] {
                let mut onto = target(mesh.clone(), 5);
                onto.n_plane.fill(n_plane);
                let mapped = map_one(&part, pose, &onto, &full());
                assert_eq!(mapped.counts()[0], mesh.len(), "all are mapped");
                let expected = rotated(&STRESS, &pose.rotation);
                for element in 0..mesh.len() {
                    assert!((mapped.thickness[element] - 1.0).abs() < 1e-12);
                    let states = mapped.states.as_ref().unwrap().of(element);
                    assert_eq!(states.len(), 5 * onto_planes(&onto, element));
                    for state in states {
                        assert_tensor(&state[..6], &expected, 1e-12 * 120.0);
                        assert!((state[6] - 0.05).abs() < 1e-12);
                    }
                    let strains = mapped.strains.as_ref().unwrap().of(element);
                    assert_eq!(strains.len(), 2);
                    assert_tensor(&strains[0], &expected.map(|x| 1e-3 * x), 1e-12);
                }
            }
        }
    }
}

fn onto_planes(target: &TargetPart, element: usize) -> usize {
    if target.mesh.is_triangle(element) {
        1
    } else {
        target.n_plane[element] as usize
    }
}

/// Area centroid of a plane quad, where the area mean of a linear field is taken.
fn area_centroid(mesh: &ShellMesh, element: usize) -> Point3 {
    let [a, b, c, d] = mesh.corner_points(element);
    let half = |p: Point3, q: Point3, r: Point3| {
        let area = (q - p).cross(&(r - p)).norm() / 2.0;
        ((p.coords + q.coords + r.coords) / 3.0 * area, area)
    };
    let (m1, a1) = half(a, b, c);
    let (m2, a2) = half(a, c, d);
    Point3::from((m1 + m2) / (a1 + a2))
}

/// Plastic strains, and stresses xy ten times as large, at four points in each of three Gauss layers.
fn four_points(
    mesh: &ShellMesh,
    element: usize,
    plastic: impl Fn(&Point3, f64) -> f64,
) -> Vec<(f64, [f64; 7])> {
    let near = (1.0 + 1.0 / 3.0_f64.sqrt()) / 2.0;
    let far = 1.0 - near;
    let corners = mesh.corner_points(element);
    let mut points = Vec::new();
    for &t in LayerRule::new(RuleKind::Gauss, 3).places() {
        for first in 0..4 {
            let weights = [near * near, near * far, far * far, near * far];
            let around = (0..4).map(|i| corners[(first + i) % 4].coords * weights[i]);
            let value = plastic(&Point3::from(around.sum::<Vector3>()), t);
            points.push((t, [0.0, 0.0, 0.0, 10.0 * value, 0.0, 0.0, value]));
        }
    }
    points
}

/// The same for all elements.
fn of_four_points(mesh: &ShellMesh, plastic: impl Fn(&Point3, f64) -> f64) -> Layered<7> {
    let mut states = Layered::new(mesh.len());
    for element in 0..mesh.len() {
        states.set(element, four_points(mesh, element, &plastic).into_iter());
    }
    states
}

#[test]
fn a_linear_field_on_a_plane_is_exact() {
    let linear = |p: &Point3| 0.2 + 0.004 * p.x + 0.003 * p.y;
    for (from, to) in [(2.5, 5.0), (5.0, 5.0), (5.0, 2.5)] {
        let mesh = Blank::new(from).mesh(flat);
        let part = source(mesh, 3, |e, _, mesh| {
            let v = linear(&mesh.centroids()[e]);
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, v]
        });
        // A target well inside, so that every point has a full stencil around its source element.
        let inner = Blank {
            length: 60.0,
            width: 30.0,
            size: to,
            jitter: 0.2,
        };
        let onto = target(inner.mesh(|u, v| Point3::new(u + 20.3, v + 15.1, 0.0)), 3);
        // The same from four points in each layer.
        let mut of_four = part.clone();
        of_four.states = of_four_points(&part.mesh, |p, _| linear(p));
        for part in [part, of_four] {
            let mapped = map_one(&part, Similarity::identity(), &onto, &full());
            for element in 0..onto.mesh.len() {
                let expected = linear(&area_centroid(&onto.mesh, element));
                let found = mapped.states.as_ref().unwrap().of(element)[1][6];
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{from} → {to}: {found} against {expected}"
                );
            }
        }
    }
}

/// The mesh with about half of its elements reversed, here and there.
fn flipped_at_random(mesh: &ShellMesh) -> ShellMesh {
    let corners = (0_u32..).zip(mesh.corners()).map(|(i, &[a, b, c, d])| {
        let is_reversed = i.wrapping_mul(2_654_435_761) >> 31 == 0;
        match (is_reversed, c == d) {
            (true, true) => [a, c, b, b],
            (true, false) => [a, d, c, b],
            (false, _) => [a, b, c, d],
        }
    });
    let corners = corners.collect();
    ShellMesh::new(mesh.positions().to_vec(), corners, mesh.parts().to_vec()).unwrap()
}

/// A field that is linear in the plane and through the thickness, given on the side of z. Whatever side the elements
/// of either mesh have their normals on, the values are those of the same material.
#[test]
fn a_linear_field_is_exact_whichever_side_normals_are_on() {
    let field = |p: &Point3, z: f64| -> [f64; 7] {
        let at = |c: [f64; 4]| c[0] + c[1] * p.x + c[2] * p.y + c[3] * z;
        [
            at([50.0, 0.4, -0.3, 20.0]),
            at([-20.0, -0.2, 0.5, -35.0]),
            0.0,
            at([10.0, 0.1, 0.2, 8.0]),
            0.0,
            0.0,
            at([0.4, 0.001, 0.001, 0.1]),
        ]
    };
    let inner = Blank {
        length: 60.0,
        width: 30.0,
        size: 5.0,
        jitter: 0.2,
    };
    let inner = inner.mesh(|u, v| Point3::new(u + 20.3, v + 15.1, 0.0));
    let fine = Blank::new(2.5).mesh(flat);
    let plies = LayerRule::of_plies(&[0.1, 0.2, 0.7]);
    let options = MapOptions {
        keep_force_and_moment: false,
        ..full()
    };
    for mesh in [flipped_at_random(&fine), flipped_at_random(&cut(&fine))] {
        let part = source(mesh, 5, |e, t, mesh| {
            field(&mesh.centroids()[e], t * mesh.normals()[e].z)
        });
        for onto in [inner.clone(), flipped_at_random(&inner)] {
            for rule in [LayerRule::new(RuleKind::Gauss, 3), plies.clone()] {
                let onto = TargetPart::uniform(onto.clone(), rule.clone(), 1.0);
                let mapped = map_one(&part, Similarity::identity(), &onto, &options);
                assert_eq!(mapped.facings, [Facing::Mixed]);
                for element in 0..onto.mesh.len() {
                    let centroid = area_centroid(&onto.mesh, element);
                    let states = mapped.states.as_ref().unwrap().of(element);
                    for (&t, found) in rule.places().iter().zip(states) {
                        let side = onto.mesh.normals()[element].z;
                        let expected = field(&centroid, side * t);
                        for (a, b) in found.iter().zip(expected) {
                            let digits = 1e-12 * b.abs().max(1.0);
                            assert!((a - b).abs() < digits, "{found:?} against {expected:?}");
                        }
                    }
                    let strains = mapped.strains.as_ref().unwrap().of(element);
                    for (t, found) in [-1.0, 1.0].into_iter().zip(strains) {
                        let side = onto.mesh.normals()[element].z;
                        let expected = field(&centroid, side * t);
                        for (a, b) in found.iter().zip(expected) {
                            assert!((a - 1e-3 * b).abs() < 1e-13, "{found:?}");
                        }
                    }
                }
            }
        }
    }
}

fn sine(p: &Point3) -> f64 {
    0.3 + 0.2
        * (std::f64::consts::TAU * p.x / 40.0).sin()
        * (std::f64::consts::TAU * p.y / 40.0).cos()
}

/// Mean of a function over a plane quad by many points.
pub(super) fn exact_mean(mesh: &ShellMesh, element: usize, f: impl Fn(&Point3) -> f64) -> f64 {
    let [a, b, c, d] = mesh.corner_points(element);
    let n = 12;
    let (mut sum, mut area) = (0.0, 0.0);
    for i in 0..n {
        for j in 0..n {
            let at = |u: f64, v: f64| {
                Point3::from(
                    a.coords * (1.0 - u) * (1.0 - v)
                        + b.coords * u * (1.0 - v)
                        + c.coords * u * v
                        + d.coords * (1.0 - u) * v,
                )
            };
            let (u, v, h) = (
                f64::from(i) / f64::from(n),
                f64::from(j) / f64::from(n),
                1.0 / f64::from(n),
            );
            let cell = (at(u + h, v) - at(u, v))
                .cross(&(at(u, v + h) - at(u, v)))
                .norm();
            sum += cell * f(&at(u + h / 2.0, v + h / 2.0));
            area += cell;
        }
    }
    sum / area
}

fn sine_error(size: f64, method: MapMethod) -> f64 {
    let mesh = Blank::new(size).mesh(flat);
    let part = source(mesh, 2, |e, _, mesh| {
        let mean = exact_mean(mesh, e, sine);
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mean]
    });
    let inner = Blank {
        length: 64.0,
        width: 32.0,
        size: 1.6 * size,
        jitter: 0.2,
    };
    let onto = target(inner.mesh(|u, v| Point3::new(u + 17.3, v + 13.1, 0.0)), 2);
    let options = MapOptions { method, ..full() };
    let mapped = map_one(&part, Similarity::identity(), &onto, &options);
    let (mut sum, mut area) = (0.0, 0.0);
    for element in 0..onto.mesh.len() {
        let found = mapped.states.as_ref().unwrap().of(element)[0][6];
        let error = found - exact_mean(&onto.mesh, element, sine);
        sum += error * error * onto.mesh.areas()[element];
        area += onto.mesh.areas()[element];
    }
    (sum / area).sqrt()
}

#[test]
fn a_smooth_field_converges_with_second_order_and_nearest_does_not() {
    let order = |method| {
        let errors = [5.0, 2.5, 1.25].map(|size| sine_error(size, method));
        (errors[0] / errors[2]).log2() / 2.0
    };
    let area = order(MapMethod::Area);
    assert!(area >= 1.8, "order {area}");
    let nearest = order(MapMethod::Nearest);
    assert!(nearest < 1.4, "order {nearest}");
    let (ours, theirs) = (
        sine_error(2.5, MapMethod::Area),
        sine_error(2.5, MapMethod::Nearest),
    );
    assert!(5.0 * ours < theirs, "{ours:e} against {theirs:e}");
    // Means at the nodes are smooth, and lower the peaks.
    let shape = order(MapMethod::Shape);
    assert!(shape >= 1.7, "order {shape}");
    let shape = sine_error(2.5, MapMethod::Shape);
    assert!(
        ours < shape && 2.0 * shape < theirs,
        "{ours:e} {shape:e} {theirs:e}"
    );
}

#[test]
fn constants_pass_through_the_nodes_as_they_are() {
    let part = source(Blank::new(5.0).mesh(cylinder), 2, |_, _, _| {
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25]
    });
    let inner = Blank {
        length: 60.0,
        width: 30.0,
        size: 7.0,
        jitter: 0.2,
    };
    let onto = target(inner.mesh(|u, v| cylinder(u + 15.0, v + 11.0)), 2);
    let options = MapOptions {
        method: MapMethod::Shape,
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &options);
    for element in 0..onto.mesh.len() {
        assert!(mapped.elements[element].status.has_values());
        for state in mapped.states.as_ref().unwrap().of(element) {
            assert!((state[6] - 0.25).abs() < 1e-12, "{}", state[6]);
        }
    }
}

#[test]
fn the_same_mesh_moved_keeps_every_bit() {
    let mesh = Blank::new(5.0).mesh(cylinder);
    let part = source(mesh.clone(), 5, |e, t, _| {
        let x = (e as f64 * 0.37).sin() + t;
        [
            100.0 * x,
            20.0 * x * x,
            -3.0 * x,
            5.0 + x,
            x,
            2.0,
            0.01 * (x + 2.0),
        ]
    });
    for pose in [Similarity::identity(), some_pose()] {
        let mapped = map_one(&part, pose, &target(mesh.moved(&pose), 5), &full());
        for element in 0..mesh.len() {
            assert_eq!(mapped.elements[element].status, Status::Mapped);
            let partner = mapped.elements[element].partner.unwrap();
            assert!(partner.is_copy && partner.element as usize == element);
            let (_, own) = part.states.of(element).unwrap();
            for (state, own) in mapped.states.as_ref().unwrap().of(element).iter().zip(own) {
                assert_eq!(state[6], own[6]);
                let own: Tensor = std::array::from_fn(|i| own[i]);
                assert_tensor(&state[..6], &rotated(&own, &pose.rotation), 1e-12 * 300.0);
                let found: Tensor = std::array::from_fn(|i| state[i]);
                assert!((von_mises(&found) - von_mises(&own)).abs() < 1e-12 * 300.0);
                assert!((principal(&found)[0] - principal(&own)[0]).abs() < 1e-12 * 300.0);
            }
        }
    }
}

#[test]
fn uneven_plies_of_a_flipped_target_take_the_layers_at_their_own_places() {
    let mesh = Blank::new(5.0).mesh(flat);
    // In line through the thickness, in the strains with more layers than the surfaces.
    let mut part = source(mesh.clone(), 3, |_, t, _| {
        [40.0 * t, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5 + 0.4 * t]
    });
    for element in 0..mesh.len() {
        let layer = |t: f64| (t, [0.01 * t, 0.0, 0.0, 0.0, 0.0, 0.0]);
        part.strains
            .set(element, [-0.8, 0.1, 0.9].map(layer).into_iter());
    }
    let rule = LayerRule::of_plies(&[0.1, 0.2, 0.7]);
    let shifted = Similarity {
        translation: Vector3::new(1.7, 0.9, 0.0),
        ..Similarity::identity()
    };
    let options = MapOptions {
        keep_force_and_moment: false,
        ..full()
    };
    // Copied, and averaged.
    for pose in [Similarity::identity(), shifted] {
        for (target_mesh, sign) in [(mesh.clone(), 1.0), (flipped(&mesh), -1.0)] {
            let onto = TargetPart::uniform(target_mesh, rule.clone(), 1.0);
            let mapped = map_one(&part, pose, &onto, &options);
            let (states, strains) = (mapped.states.unwrap(), mapped.strains.unwrap());
            for (element, report) in mapped.elements.iter().enumerate() {
                if !report.status.has_values() {
                    continue;
                }
                let found = states.of(element).iter().zip(strains.of(element));
                for (&t, (state, strain)) in rule.places().iter().zip(found) {
                    assert!((state[0] - sign * 40.0 * t).abs() < 1e-12, "{t}: {state:?}");
                    assert!((state[6] - (0.5 + sign * 0.4 * t)).abs() < 1e-12);
                    assert!((strain[0] - sign * 0.01 * t).abs() < 1e-14);
                }
            }
        }
    }
}

#[test]
fn a_copy_keeps_the_points_of_each_layer() {
    let mesh = Blank::new(5.0).mesh(flat);
    let mut part = source(mesh.clone(), 3, uniform);
    let plastic = |p: &Point3, t: f64| 0.5 + 0.004 * p.x + 0.0003 * p.y * p.x + 0.1 * t;
    part.states = of_four_points(&mesh, plastic);
    for pose in [Similarity::identity(), some_pose(), Similarity::mirror_x()] {
        let moved = mesh.moved(&pose);
        for corners in [[0, 1, 2, 3], [1, 2, 3, 0], [0, 3, 2, 1], [2, 1, 0, 3]] {
            let turned = moved.corners().iter().map(|own| corners.map(|i| own[i]));
            let turned = ShellMesh::new(
                moved.positions().to_vec(),
                turned.collect(),
                moved.parts().to_vec(),
            );
            let mut onto = target(turned.unwrap(), 3);
            onto.n_plane.fill(4);
            let mapped = map_one(&part, pose, &onto, &full());
            for element in 0..mesh.len() {
                let is_flipped = mapped.elements[element].partner.unwrap().is_flipped;
                let found = mapped.states.as_ref().unwrap().of(element);
                let own = four_points(&mesh, element, plastic);
                for (i, state) in found.iter().enumerate() {
                    let layer = if is_flipped { 2 - i / 4 } else { i / 4 };
                    let (_, own) = own[4 * layer + corners[i % 4]];
                    assert_eq!(state[6], own[6]);
                    let own: Tensor = std::array::from_fn(|i| own[i]);
                    assert_tensor(&state[..6], &rotated(&own, &pose.rotation), 1e-12 * 10.0);
                }
            }
        }
    }
}

#[test]
fn a_flipped_target_takes_the_layers_from_the_other_side() {
    let mesh = Blank::new(5.0).mesh(flat);
    let part = source(mesh.clone(), 5, |_, t, _| {
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5 + 0.4 * t]
    });
    let onto = target(flipped(&mesh), 5);
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    assert_eq!(mapped.facings, [Facing::Opposite]);
    let straight = map_one(&part, Similarity::identity(), &target(mesh, 5), &full());
    for element in 0..onto.mesh.len() {
        let reversed: Vec<_> = mapped
            .states
            .as_ref()
            .unwrap()
            .of(element)
            .iter()
            .rev()
            .collect();
        let plain: Vec<_> = straight
            .states
            .as_ref()
            .unwrap()
            .of(element)
            .iter()
            .collect();
        assert_eq!(reversed, plain);
    }
}

/// Elements whose corners go the other way round than those around them have the values of the same material, whether
/// the stamped elements there are turned over too or not.
#[test]
fn a_few_reversed_elements_are_mapped_as_the_sheet_they_lie_in() {
    let some_flipped = |mesh: &ShellMesh, every: usize| {
        let all = flipped(mesh);
        let pairs = mesh.corners().iter().zip(all.corners()).enumerate();
        let corners = pairs.map(|(e, (own, other))| if e % every == 7 { *other } else { *own });
        let parts = mesh.parts().to_vec();
        ShellMesh::new(mesh.positions().to_vec(), corners.collect(), parts).unwrap()
    };
    let fine = Blank::new(3.0).mesh(flat);
    let onto = Blank {
        length: 60.0,
        width: 40.0,
        size: 5.0,
        jitter: 0.2,
    };
    let onto = onto.mesh(|u, v| flat(u + 20.3, v + 10.1));
    for mesh in [fine.clone(), some_flipped(&fine, 31)] {
        let part = source(mesh, 5, |e, t, mesh| {
            let (at, t) = (mesh.centroids()[e], t * mesh.normals()[e].z);
            let x = 0.1 * at.x + 3.0 * t;
            [x, 2.0 * x, 3.0, x, 2.0 + x, 1.0, 0.2 + 0.05 * t]
        });
        let straight = map_one(
            &part,
            Similarity::identity(),
            &target(onto.clone(), 5),
            &full(),
        );
        for every in [20, 40] {
            let reversed = target(some_flipped(&onto, every), 5);
            let mapped = map_one(&part, Similarity::identity(), &reversed, &full());
            assert_eq!(mapped.facings, [Facing::Same]);
            for element in 0..onto.len() {
                assert_eq!(mapped.elements[element].status, Status::Mapped);
                let [found, plain] =
                    [&mapped, &straight].map(|of| of.states.as_ref().unwrap().of(element).to_vec());
                let plain = if element % every == 7 {
                    plain.into_iter().rev().collect()
                } else {
                    plain
                };
                for (a, b) in found.iter().flatten().zip(plain.iter().flatten()) {
                    assert!((a - b).abs() < 1e-9, "{element}: {a} and {b}");
                }
            }
        }
    }
}

#[test]
fn hoop_stress_on_a_radius_stays_in_the_sheet() {
    let hoop = |e: usize, _: f64, mesh: &ShellMesh| {
        let n = mesh.normals()[e];
        let along = Vector3::x().cross(&n).normalize();
        let s = 100.0;
        let a = along;
        [
            s * a.x * a.x,
            s * a.y * a.y,
            s * a.z * a.z,
            s * a.x * a.y,
            s * a.y * a.z,
            s * a.z * a.x,
            0.0,
        ]
    };
    let blank = |size| Blank {
        length: 40.0,
        width: 25.0,
        size,
        jitter: 0.0,
    };
    let part = source(blank(2.5).mesh(cylinder), 2, hoop);
    let coarse = blank(5.0).mesh(|u, v| cylinder(0.8 * u + 4.0, 0.8 * v + 2.5));
    let mapped = map_one(
        &part,
        Similarity::identity(),
        &target(coarse.clone(), 2),
        &full(),
    );
    for element in 0..coarse.len() {
        let n = coarse.normals()[element];
        for state in mapped.states.as_ref().unwrap().of(element) {
            let stress: Tensor = std::array::from_fn(|i| state[i]);
            let m = Matrix3::new(
                stress[0], stress[3], stress[5], stress[3], stress[1], stress[4], stress[5],
                stress[4], stress[2],
            );
            let traction = m * n;
            assert!(
                traction.norm() < 1e-10,
                "normal and shear traction {traction}"
            );
            assert!((von_mises(&stress) - 100.0).abs() < 0.5);
        }
    }
}

#[test]
fn a_blank_of_two_gauges_has_no_gauge_between() {
    let mesh = Blank::new(2.5).mesh(flat);
    let mut part = source(mesh.clone(), 2, uniform);
    for (thickness, centre) in part.thickness.iter_mut().zip(mesh.centroids()) {
        *thickness = if centre.x < 47.0 { [0.8; 4] } else { [1.6; 4] };
    }
    let onto = target(Blank::new(5.0).mesh(flat), 2);
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    for thickness in &mapped.thickness {
        let is_gauge = |gauge: f64| (thickness - gauge).abs() < 1e-12;
        assert!(is_gauge(0.8) || is_gauge(1.6), "{thickness}");
    }
}

/// Finer elements take what the thickness at the corners of a coarse one says there, not its mean.
#[test]
fn thickness_varies_within_a_stamped_element() {
    let blank = |size| Blank {
        jitter: 0.0,
        length: 60.0,
        ..Blank::new(size)
    };
    let mut part = source(blank(60.0).mesh(flat), 2, uniform);
    assert_eq!(part.thickness.len(), 1);
    let corners = part.mesh.corner_points(0);
    part.thickness[0] = std::array::from_fn(|at| 1.0 + corners[at].x / 60.0);
    let onto = target(blank(10.0).mesh(flat), 2);
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    for (thickness, centre) in mapped.thickness.iter().zip(onto.mesh.centroids()) {
        let expected = 1.0 + centre.x / 60.0;
        assert!(
            (thickness - expected).abs() < 1e-9,
            "{thickness} at {centre}"
        );
    }
}

/// A file without results beside one of the same sheet with them, as a mesh beside its dynain, takes no element.
#[test]
fn a_sheet_without_results_takes_nothing_from_one_with_them() {
    let mesh = Blank::new(2.5).mesh(flat);
    let full_part = source(mesh.clone(), 2, uniform);
    let mut bare = full_part.clone();
    bare.thickness = vec![[f64::NAN; 4]; mesh.len()];
    (bare.states, bare.strains) = (Layered::new(mesh.len()), Layered::new(mesh.len()));
    let onto = target(Blank::new(5.0).mesh(flat), 2);
    let alone = map_one(&full_part, Similarity::identity(), &onto, &full());
    for order in [[&bare, &full_part], [&full_part, &bare]] {
        let placed = order.map(|part| PlacedSource {
            part,
            target_from_source: Similarity::identity(),
        });
        let mapped = map(&placed, &onto, &full(), &Monitor::silent()).unwrap();
        assert_eq!(mapped.thickness, alone.thickness);
        let statuses = mapped.elements.iter().map(|element| element.status);
        assert!(statuses.eq(alone.elements.iter().map(|element| element.status)));
    }
}

/// A skin at z = 0 that faces up, with plastic strain 0.1, and a folded flange of a length 1.5 above it that faces
/// down, with 0.9.
fn hemmed(length: f64) -> SourcePart {
    let skin = Blank::new(5.0).mesh(flat);
    let flange = Blank {
        length,
        ..Blank::new(5.0)
    };
    let flange = flipped(&flange.mesh(|u, v| Point3::new(u, v, 1.5)));
    let n = skin.positions().len() as u32;
    let mut positions = skin.positions().to_vec();
    positions.extend_from_slice(flange.positions());
    let mut corners = skin.corners().to_vec();
    corners.extend(flange.corners().iter().map(|c| c.map(|v| v + n)));
    let n_skin = skin.len();
    let both = ShellMesh::new(positions, corners, vec![0; n_skin + flange.len()]).unwrap();
    source(both, 2, |e, _, _| {
        [
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            if e < n_skin { 0.1 } else { 0.9 },
        ]
    })
}

#[test]
fn sheets_of_a_hem_are_told_apart_by_what_lies_beside_it() {
    // Under the flange the closer sheet is the wrong one, and nothing but the other 60 % of the skin says so.
    let onto = target(Blank::new(7.0).mesh(|u, v| Point3::new(u, v, 0.8)), 2);
    let mapped = map_one(&hemmed(40.0), Similarity::identity(), &onto, &full());
    assert_eq!(mapped.facings, [Facing::Same]);
    for element in 0..onto.mesh.len() {
        let value = mapped.states.as_ref().unwrap().of(element)[0][6];
        assert!((value - 0.1).abs() < 1e-12, "{value}");
    }
}

#[test]
fn elements_that_are_turned_over_here_and_there_are_no_sheets_of_their_own() {
    let mesh = Blank::new(5.0).mesh(flat);
    let turned = mesh.corners().iter().enumerate();
    let turned = turned.map(|(e, &[a, b, c, d])| {
        if e % 7 == 0 {
            [a, d, c, b]
        } else {
            [a, b, c, d]
        }
    });
    let (n, positions) = (mesh.len(), mesh.positions().to_vec());
    let mesh = ShellMesh::new(positions, turned.collect(), vec![0; n]).unwrap();
    let onto = target(Blank::new(7.0).mesh(|u, v| Point3::new(u, v, 0.8)), 2);
    let mapped = map_one(
        &source(mesh, 2, uniform),
        Similarity::identity(),
        &onto,
        &full(),
    );
    assert_eq!(mapped.facings, [Facing::Mixed]);
    assert_eq!(mapped.counts()[Status::Mapped as usize], onto.mesh.len());
}

#[test]
fn a_hem_does_not_leak() {
    let part = hemmed(100.0);
    // The crash skin is 0.8 too high, so that the flange is the nearer sheet.
    let onto = target(Blank::new(7.0).mesh(|u, v| Point3::new(u, v, 0.8)), 2);
    let signed = MapOptions {
        normal_sense: NormalSense::Signed,
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &signed);
    assert_eq!(mapped.counts()[Status::Mapped as usize], onto.mesh.len());
    for element in 0..onto.mesh.len() {
        let value = mapped.states.as_ref().unwrap().of(element)[0][6];
        assert!((value - 0.1).abs() < 1e-12, "{value}");
    }
    let either = MapOptions {
        normal_sense: NormalSense::Either,
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &either);
    let flagged = mapped.counts()[Status::TwoLayers as usize];
    assert_eq!(flagged, onto.mesh.len(), "every doubtful element is marked");
}

#[test]
fn elements_without_counterpart_say_why() {
    let part = source(Blank::new(5.0).mesh(flat), 2, uniform);
    let wide = Blank {
        length: 160.0,
        width: 60.0,
        size: 5.0,
        jitter: 0.0,
    };
    let onto = target(wide.mesh(flat), 2);
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    let counts = mapped.counts();
    assert_eq!(counts.iter().sum::<usize>(), onto.mesh.len());
    assert_eq!(counts[Status::Outside as usize], 12 * 12, "beyond x = 100");
    assert_eq!(counts[Status::Mapped as usize], 20 * 12);
    for (report, thickness) in mapped.elements.iter().zip(&mapped.thickness) {
        assert_eq!(report.status.has_values(), thickness.is_finite());
    }
    let high = target(Blank::new(5.0).mesh(|u, v| Point3::new(u, v, 8.0)), 2);
    let mapped = map_one(&part, Similarity::identity(), &high, &full());
    assert_eq!(mapped.counts()[Status::Far as usize], high.mesh.len());
    let upright = target(
        Blank::new(5.0).mesh(|u, v| Point3::new(u, 30.0, v - 30.0)),
        2,
    );
    let mapped = map_one(&part, Similarity::identity(), &upright, &full());
    assert!(mapped.counts()[Status::Angle as usize] > 0);
    assert_eq!(mapped.counts()[Status::Mapped as usize], 0);
}

/// Where the sheet over the middle of an element lies beyond the largest distance, the element is measured by the
/// partners of its other points.
#[test]
fn elements_are_measured_where_their_middle_has_no_partner() {
    let ridge: Shape = |u, v| {
        let is_high = (u - 50.0).abs() < 4.0;
        Point3::new(u, v, if is_high { 3.0 } else { 0.1 })
    };
    let fine = Blank {
        jitter: 0.0,
        ..Blank::new(2.5)
    };
    let coarse = Blank {
        jitter: 0.0,
        ..Blank::new(20.0)
    };
    let part = source(fine.mesh(ridge), 2, uniform);
    let onto = target(coarse.mesh(flat), 2);
    let options = MapOptions {
        max_distance: Some(1.0),
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &options);
    let mut n_under_ridge = 0;
    for (report, centre) in mapped.elements.iter().zip(onto.mesh.centroids()) {
        assert!(report.partner.is_some(), "{report:?}");
        assert!((report.normal_distance - 0.1).abs() < 1e-9, "{report:?}");
        assert!(report.angle_deg < 1e-3 && report.tangential_distance.is_finite());
        assert!(
            (report.confidence - report.coverage).abs() < 1e-9,
            "{report:?}"
        );
        if (centre.x - 50.0).abs() < 1.0 {
            assert_eq!(report.status, Status::Partly);
            n_under_ridge += 1;
        }
    }
    assert_eq!(n_under_ridge, 3);
    assert!((mapped.median_offset - 0.1).abs() < 1e-9);
    assert_eq!(mapped.n_distant, 0);
}

#[test]
fn an_element_of_which_half_has_results_takes_them() {
    let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let rows = [0.0, 40.0].map(|y| [at(0.0, y), at(40.0, y), at(80.0, y)]);
    let corners = vec![[0, 1, 4, 3], [1, 2, 5, 4]];
    let mesh = ShellMesh::new(rows.concat(), corners, vec![0; 2]).unwrap();
    let mut part = source(mesh, 2, uniform);
    part.thickness[1] = [f64::NAN; 4];
    let whole = part.clone();
    part.states = Layered::new(2);
    part.strains = Layered::new(2);
    let (rule, values) = whole.states.of(0).unwrap();
    part.states
        .set(0, rule.places().iter().copied().zip(values.iter().copied()));
    let (rule, values) = whole.strains.of(0).unwrap();
    part.strains
        .set(0, rule.places().iter().copied().zip(values.iter().copied()));
    let square = vec![
        at(36.0, 16.0),
        at(44.0, 16.0),
        at(44.0, 24.0),
        at(36.0, 24.0),
    ];
    let square = ShellMesh::new(square, vec![[0, 1, 2, 3]], vec![0]).unwrap();
    let mapped = map_one(&part, Similarity::identity(), &target(square, 2), &full());
    assert_eq!(mapped.elements[0].status, Status::Mapped);
    assert!((mapped.thickness[0] - 1.0).abs() < 1e-12);
    assert_eq!(mapped.states.unwrap().of(0).len(), 2);
    assert_eq!(mapped.strains.unwrap().of(0).len(), 2);
}

/// A flat crash part that is as wide as the stamped blank and so long.
fn longer_blank(length: f64) -> TargetPart {
    let blank = Blank {
        length,
        width: 60.0,
        size: 5.0,
        jitter: 0.0,
    };
    target(blank.mesh(flat), 2)
}

#[test]
fn unmapped_rings_are_filled_and_marked() {
    let part = source(Blank::new(5.0).mesh(flat), 2, uniform);
    let onto = longer_blank(120.0);
    let options = MapOptions {
        fill_rings: 2,
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &options);
    assert_eq!(mapped.counts()[Status::Filled as usize], 2 * 12);
    for element in 0..onto.mesh.len() {
        if mapped.elements[element].status == Status::Filled {
            assert!((mapped.thickness[element] - 1.0).abs() < 1e-12);
            for state in mapped.states.as_ref().unwrap().of(element) {
                assert_eq!(state[..6], [0.0; 6]);
                assert!((state[6] - 0.05).abs() < 1e-12);
            }
        }
    }
}

/// Each side of the sheet keeps its plastic strain where the normals of neighbours point to opposite sides.
#[test]
fn filled_elements_keep_the_sides_of_the_sheet() {
    let through = |_: usize, t: f64, _: &ShellMesh| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1 + 0.05 * t];
    let part = source(Blank::new(5.0).mesh(flat), 3, through);
    let mut onto = longer_blank(120.0);
    let mesh = &onto.mesh;
    let reversed = |(element, corners): (usize, &[u32; 4])| {
        let [a, b, c, d] = *corners;
        if element % 3 == 0 {
            [d, c, b, a]
        } else {
            *corners
        }
    };
    let corners = mesh.corners().iter().enumerate().map(reversed).collect();
    onto.mesh = ShellMesh::new(mesh.positions().to_vec(), corners, mesh.parts().to_vec()).unwrap();
    let options = MapOptions {
        fill_rings: 2,
        ..full()
    };
    for n_plane in [1, 4] {
        onto.n_plane.fill(n_plane);
        let mapped = map_one(&part, Similarity::identity(), &onto, &options);
        assert_eq!(mapped.counts()[Status::Filled as usize], 2 * 12);
        let states = mapped.states.as_ref().unwrap();
        for element in 0..onto.mesh.len() {
            let places = onto.rules[0].places().iter();
            let side = onto.mesh.normals()[element].z.signum();
            let n = usize::from(n_plane);
            for (place, layer) in places.zip(states.of(element).chunks(n)) {
                for state in layer {
                    let expected = 0.1 + 0.05 * side * place;
                    assert!((state[6] - expected).abs() < 1e-9, "{element}: {state:?}");
                }
            }
        }
    }
}

/// A stamped part without thickness beyond x = 50, and one without states there.
fn without_a_half(whole: &SourcePart) -> [SourcePart; 2] {
    let [mut no_thickness, mut no_states] = [whole.clone(), whole.clone()];
    no_states.states = Layered::new(whole.mesh.len());
    for (element, centre) in whole.mesh.centroids().iter().enumerate() {
        if centre.x > 50.0 {
            no_thickness.thickness[element] = [f64::NAN; 4];
        } else {
            let (rule, values) = whole.states.of(element).unwrap();
            let points = rule.places().iter().copied().zip(values.iter().copied());
            no_states.states.set(element, points);
        }
    }
    [no_thickness, no_states]
}

/// These quantities, of "thickness", "plastic", "strain" and "stress".
fn quantities(names: &str) -> Quantities {
    Quantities {
        thickness: names.contains("thickness"),
        plastic_strain: names.contains("plastic"),
        strain: names.contains("strain"),
        stress: names.contains("stress"),
        history: false,
    }
}

#[test]
fn filled_elements_have_a_value() {
    let whole = source(Blank::new(5.0).mesh(flat), 2, uniform);
    let [no_thickness, no_states] = without_a_half(&whole);
    let onto = longer_blank(120.0);
    for (part, names, n_filled) in [
        (&whole, "thickness", 24),
        (&whole, "plastic", 24),
        (&whole, "strain", 0),
        (&whole, "stress", 0),
        (&whole, "strain, stress", 0),
        (&no_thickness, "thickness, strain", 0),
        (&no_thickness, "thickness, plastic", 24),
        (&no_states, "plastic, strain", 0),
        (&no_states, "thickness, plastic", 24),
    ] {
        let options = MapOptions {
            quantities: quantities(names),
            fill_rings: 2,
            ..MapOptions::default()
        };
        let mapped = map_one(part, Similarity::identity(), &onto, &options);
        let is_filled = |element: &usize| mapped.elements[*element].status == Status::Filled;
        let mut filled = (0..onto.mesh.len()).filter(is_filled);
        assert_eq!(filled.clone().count(), n_filled, "{names}");
        assert!(filled.all(|element| {
            let thickness = mapped.thickness.get(element);
            let states = mapped.states.as_ref();
            thickness.is_some_and(|t| t.is_finite())
                || states.is_some_and(|states| !states.of(element).is_empty())
        }));
    }
}

#[test]
fn filling_ends_where_there_is_nothing_to_fill() {
    let part = source(Blank::new(5.0).mesh(flat), 2, uniform);
    let onto = longer_blank(140.0);
    let options = MapOptions {
        fill_rings: usize::MAX,
        ..full()
    };
    let counts = map_one(&part, Similarity::identity(), &onto, &options).counts();
    assert!(counts[Status::Filled as usize] > 0);
    assert_eq!(counts[Status::Outside as usize], 0);
}

#[test]
fn elements_without_results_say_so_and_spoil_no_neighbour() {
    let mesh = Blank::new(5.0).mesh(flat);
    let mut part = source(mesh.clone(), 2, uniform);
    let full_states = part.states.clone();
    part.states = Layered::new(mesh.len());
    for (element, centre) in mesh.centroids().iter().enumerate() {
        if centre.x > 50.0 {
            part.thickness[element] = [f64::NAN; 4];
        } else {
            let (rule, values) = full_states.of(element).unwrap();
            part.states.set(
                element,
                rule.places().iter().copied().zip(values.iter().copied()),
            );
        }
    }
    part.strains = Layered::new(mesh.len());
    let mapped = map_one(
        &part,
        Similarity::identity(),
        &target(Blank::new(4.0).mesh(flat), 2),
        &full(),
    );
    let counts = mapped.counts();
    assert!(counts[Status::NoData as usize] > 100);
    for (element, report) in mapped.elements.iter().enumerate() {
        if report.status.has_values() {
            assert!((mapped.thickness[element] - 1.0).abs() < 1e-12);
        } else {
            assert!(mapped.thickness[element].is_nan());
            assert!(mapped.states.as_ref().unwrap().of(element).is_empty());
        }
    }
}

/// The number of elements that have a thickness, which is that of a gauge.
fn n_of_gauge(mapped: &Mapped, gauge: f64) -> usize {
    let known = mapped.thickness.iter().filter(|t| t.is_finite());
    assert!(known.clone().all(|t| (t - gauge).abs() < 1e-12));
    known.count()
}

#[test]
fn two_stamped_parts_share_one_crash_part() {
    let left = Blank {
        length: 50.0,
        width: 60.0,
        size: 5.0,
        jitter: 0.0,
    };
    let mut a = source(left.mesh(flat), 2, uniform);
    a.thickness.fill([0.7; 4]);
    let mut b = source(left.mesh(|u, v| Point3::new(u + 50.0, v, 0.0)), 2, uniform);
    b.thickness.fill([1.5; 4]);
    let onto = target(
        Blank {
            jitter: 0.0,
            ..Blank::new(4.0)
        }
        .mesh(flat),
        2,
    );
    let place = |part| PlacedSource {
        part,
        target_from_source: Similarity::identity(),
    };
    let mapped = map(&[place(&a), place(&b)], &onto, &full(), &Monitor::silent()).unwrap();
    assert_eq!(mapped.counts()[Status::Mapped as usize], onto.mesh.len());
    for (thickness, centre) in mapped.thickness.iter().zip(onto.mesh.centroids()) {
        let is_gauge = |gauge: f64| (thickness - gauge).abs() < 1e-12;
        // The row of elements that the weld line cuts in halves takes one gauge or the other.
        assert!(is_gauge(0.7) || is_gauge(1.5), "{thickness} at {centre}");
        if (centre.x - 50.0).abs() > 2.0 {
            assert!(is_gauge(if centre.x < 50.0 { 0.7 } else { 1.5 }));
        }
    }
    // The same sheet twice is a conflict, and the choice decides.
    let mut c = a.clone();
    c.thickness.fill([2.0; 4]);
    let options = MapOptions {
        overlap: Overlap::Thicker,
        ..full()
    };
    let mapped = map(&[place(&a), place(&c)], &onto, &options, &Monitor::silent()).unwrap();
    assert!(mapped.counts()[Status::Conflict as usize] > 100);
    assert!(n_of_gauge(&mapped, 2.0) > 100);
    // A sheet of unknown thickness is the thinner one, whichever is named first.
    let mut unknown = a.clone();
    unknown.thickness.fill([f64::NAN; 4]);
    for places in [[place(&unknown), place(&a)], [place(&a), place(&unknown)]] {
        let mapped = map(&places, &onto, &options, &Monitor::silent()).unwrap();
        assert!(mapped.counts()[Status::Conflict as usize] > 100);
        assert!(n_of_gauge(&mapped, 0.7) > 100);
    }
}

#[test]
fn a_source_with_the_target_s_own_mesh_does_not_hide_another() {
    let mesh = Blank::new(4.0).mesh(flat);
    let mut own = source(mesh.clone(), 2, uniform);
    own.thickness.fill([1.0; 4]);
    let mut formed = source(Blank::new(2.5).mesh(flat), 2, uniform);
    formed.thickness.fill([0.9; 4]);
    let onto = target(mesh, 2);
    let place = |part| PlacedSource {
        part,
        target_from_source: Similarity::identity(),
    };
    let places = [place(&formed), place(&own)];
    for (method, overlap, expected) in [
        (MapMethod::Area, Overlap::First, 0.9),
        (MapMethod::Area, Overlap::Thicker, 1.0),
        (MapMethod::Nearest, Overlap::First, 0.9),
        (MapMethod::Nearest, Overlap::Thicker, 1.0),
    ] {
        let options = MapOptions {
            method,
            overlap,
            ..full()
        };
        let mapped = map(&places, &onto, &options, &Monitor::silent()).unwrap();
        let inner = (0..onto.mesh.len()).filter(|&element| {
            let centre = onto.mesh.centroids()[element];
            (8.0..92.0).contains(&centre.x) && (8.0..52.0).contains(&centre.y)
        });
        for element in inner {
            assert_eq!(mapped.elements[element].status, Status::Conflict);
            let found = mapped.thickness[element];
            assert!(
                (found - expected).abs() < 1e-12,
                "{method:?} {overlap:?} {found}"
            );
        }
    }
}

#[test]
fn mapping_back_returns_what_was_there() {
    let part = source(Blank::new(2.5).mesh(flat), 3, |e, _, mesh| {
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, sine(&mesh.centroids()[e])]
    });
    let onto = target(Blank::new(3.1).mesh(flat), 3);
    let placed = PlacedSource {
        part: &part,
        target_from_source: Similarity::identity(),
    };
    let monitor = Monitor::silent();
    let mapped = map(&[placed], &onto, &full(), &monitor).unwrap();
    let back = map_back(&[placed], &onto, &mapped, &full(), &monitor).unwrap();
    assert!(back.coverage > 0.99);
    assert!(back.thickness.rms < 1e-12);
    assert!(back.plastic.rms < 0.03 * back.plastic.range, "{back:?}");
}

#[test]
fn the_result_does_not_depend_on_threads_and_mirrors_undo_each_other() {
    let mesh = Blank::new(2.5).mesh(cylinder);
    let part = source(mesh, 5, |e, t, _| {
        let x = (e as f64 * 0.11).sin() + t;
        [10.0 * x, 5.0 * x, 3.0, x, 2.0, 1.0, 0.2 + 0.05 * x]
    });
    let onto = target(Blank::new(4.1).mesh(cylinder), 3);
    let run = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build()
            .unwrap();
        pool.install(|| map_one(&part, Similarity::identity(), &onto, &full()))
    };
    let one = run(1);
    assert_eq!(format!("{:?}", one.states), format!("{:?}", run(3).states));
    assert_eq!(
        format!("{:?}", one.thickness),
        format!("{:?}", run(8).thickness)
    );
    // Mapping onto the mirrored part and undoing the mirror of the tensors.
    let mirror = Similarity::mirror_x();
    let mirrored = map_one(&part, mirror, &target(onto.mesh.moved(&mirror), 3), &full());
    for element in 0..onto.mesh.len() {
        let plain = one.states.as_ref().unwrap().of(element);
        let turned = mirrored.states.as_ref().unwrap().of(element);
        assert_eq!(plain.len(), turned.len());
        for (a, b) in plain.iter().zip(turned) {
            let back = rotated(&std::array::from_fn(|i| b[i]), &mirror.rotation);
            assert_tensor(&a[..6], &back, 1e-9);
            assert!((a[6] - b[6]).abs() < 1e-12);
        }
    }
}

#[test]
fn the_result_does_not_depend_on_how_elements_are_numbered() {
    let part = source(Blank::new(2.5).mesh(cylinder), 5, |e, t, _| {
        let x = (e as f64 * 0.11).sin() + t;
        [10.0 * x, 5.0 * x, 3.0, x, 2.0, 1.0, 0.2 + 0.05 * x]
    });
    let mesh = Blank::new(4.1).mesh(cylinder);
    let n = mesh.len();
    // 7919 is a prime that divides no such number of elements: every element comes once.
    let order: Vec<usize> = (0..n).map(|i| i * 7919 % n).collect();
    let corners = order.iter().map(|&e| mesh.corners()[e]).collect();
    let parts = vec![mesh.parts()[0]; n];
    let shuffled = ShellMesh::new(mesh.positions().to_vec(), corners, parts).unwrap();
    let plain = map_one(&part, Similarity::identity(), &target(mesh, 3), &full());
    let other = map_one(&part, Similarity::identity(), &target(shuffled, 3), &full());
    assert!(n > 256, "more than one chunk: {n}");
    for (at, &element) in order.iter().enumerate() {
        assert_eq!(plain.elements[element], other.elements[at]);
        assert_eq!(plain.thickness[element], other.thickness[at]);
        let states = |of: &Mapped, element| of.states.as_ref().unwrap().of(element).to_vec();
        assert_eq!(states(&plain, element), states(&other, at));
    }
}

#[test]
fn wrong_choices_and_missing_results_are_named() {
    let part = source(Blank::new(20.0).mesh(flat), 2, uniform);
    let onto = target(Blank::new(20.0).mesh(flat), 2);
    let place = PlacedSource {
        part: &part,
        target_from_source: Similarity::identity(),
    };
    let fails =
        |options: MapOptions| map(&[place], &onto, &options, &Monitor::silent()).unwrap_err();
    let bad = fails(MapOptions {
        max_distance: Some(-1.0),
        ..full()
    });
    assert_eq!(
        bad.to_string(),
        "the largest distance is -1, but must be above 0"
    );
    let bare = SourcePart {
        thickness: Vec::new(),
        states: Layered::new(part.mesh.len()),
        strains: Layered::new(part.mesh.len()),
        history: SourceHistory::default(),
        laws: BTreeMap::new(),
        mesh: part.mesh.clone(),
    };
    let place = PlacedSource {
        part: &bare,
        target_from_source: Similarity::identity(),
    };
    let none = map(&[place], &onto, &full(), &Monitor::silent()).unwrap_err();
    assert_eq!(none, MappingError::NoResults);
    let cancelled = Monitor::silent();
    cancelled.request_cancel();
    let place = PlacedSource {
        part: &part,
        target_from_source: Similarity::identity(),
    };
    let ended = map(&[place], &onto, &full(), &cancelled).unwrap_err();
    assert!(matches!(ended, MappingError::Cancelled(_)));
}

/// Counts how often the work looks whether it is to end.
#[derive(Default)]
struct Questions(AtomicUsize);

impl Observer for Questions {
    fn asked(&self) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }
}

#[test]
fn filling_and_corners_look_whether_they_are_to_end() {
    let part = source(Blank::new(20.0).mesh(flat), 2, uniform);
    let place = PlacedSource {
        part: &part,
        target_from_source: Similarity::identity(),
    };
    let n_asked = |options: MapOptions| {
        // A mesh that was mapped onto before knows its neighbours already.
        let onto = target(Blank::new(20.0).mesh(flat), 2);
        let questions = Arc::new(Questions::default());
        let monitor = Monitor::with_observer(Arc::clone(&questions) as Arc<dyn Observer>);
        map(&[place], &onto, &options, &monitor).unwrap();
        questions.0.load(Ordering::SeqCst)
    };
    let usual = n_asked(full());
    let filled = n_asked(MapOptions {
        fill_rings: 1,
        ..full()
    });
    let at_corners = n_asked(MapOptions {
        corner_thickness: true,
        ..full()
    });
    assert!(
        filled > usual && at_corners > usual,
        "{usual} {filled} {at_corners}"
    );
}
