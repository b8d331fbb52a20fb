//! Which elements of a sheet lie beside each other, and where it ends.
//!
//! Borders are found in these lists and not by `geometry::Topology`, which would be of all triangles of the sheet.
//! Only around the borders such a topology is made, to tell cracks of no width from them as it does.

use std::collections::HashMap;

use rayon::prelude::*;

use super::shells::ShellMesh;
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::geometry::cracks::without_cracks;
use crate::geometry::{Topology, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// Elements that one thread takes at a time.
const CHUNK: usize = 4096;
/// At a node of more elements, as in the middle of a fan, only those beside each other are neighbours: lists of all of
/// them would take memory by the square of their number.
const MOST_AT_NODE: usize = 128;
/// Where more elements than these share an edge between two such nodes, there is no sheet, and none are neighbours.
const MOST_AT_EDGE: usize = 8;

/// Neighbours and border of a sheet.
#[derive(Debug, Clone)]
pub struct Links {
    /// The elements around each element.
    pub neighbours: Neighbours,
    /// Bit i of an element: the edge from corner i to the next lies on the border.
    border_edges: Vec<u8>,
    /// For each node whether it lies on the border.
    is_border_node: Vec<bool>,
}

impl Links {
    /// O(elements).
    pub(super) fn of(mesh: &ShellMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        let merged = mesh.merged_nodes(monitor)?;
        let n_merged = n_merged(&merged);
        let corners_of = merged_corners(mesh, &merged, monitor)?;
        let mut links = Self::before_cracks(mesh, n_merged, &corners_of, monitor)?;
        links.leave_out_cracks(mesh, &merged, &corners_of, monitor)?;
        let mut is_border = vec![false; n_merged];
        for_chunks(corners_of.len(), monitor, |range| {
            for (corners, &bits) in corners_of[range.clone()]
                .iter()
                .zip(&links.border_edges[range])
            {
                for [i, j] in edges(corners) {
                    if bits & (1 << i) != 0 {
                        for end in [corners[i], corners[j]] {
                            if let Some(border) = is_border.get_mut(end as usize) {
                                *border = true;
                            }
                        }
                    }
                }
            }
        })?;
        let of_node = |node: &u32| is_border.get(*node as usize).is_some_and(|&border| border);
        links.is_border_node = merged.iter().map(of_node).collect();
        Ok(links)
    }

    /// The links with the sides of cracks among the border edges, and without the border's nodes.
    fn before_cracks(
        mesh: &ShellMesh,
        n_merged: usize,
        corners_of: &[[u32; 4]],
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let nodes_of = |element: usize| {
            let corners = &corners_of[element];
            let distinct = if corners[2] == corners[3] { 3 } else { 4 };
            // A node that only collapsed elements name has no number.
            let nodes = corners.iter().take(distinct);
            nodes.copied().filter(|&node| node != u32::MAX)
        };
        let around_node = Lists::group([n_merged, mesh.len()], nodes_of, monitor)?;
        let has_area = |element: u32| mesh.areas()[element as usize] > 0.0;
        let around_edge = CrowdedEdges::of(corners_of, &around_node, has_area, monitor)?;
        let chunks: Vec<Chunk> = corners_of
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, corners)| {
                monitor.check()?;
                let first = chunk * CHUNK;
                Ok(Chunk::of(
                    first,
                    corners,
                    (&around_node, &around_edge),
                    corners_of,
                    has_area,
                ))
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut links = Self {
            neighbours: Neighbours {
                lists: Lists {
                    start: Vec::with_capacity(mesh.len() + 1),
                    items: Vec::with_capacity(chunks.iter().map(|chunk| chunk.items.len()).sum()),
                },
                is_reversed: Vec::new(),
            },
            border_edges: Vec::with_capacity(mesh.len()),
            is_border_node: Vec::new(),
        };
        let Lists { start, items } = &mut links.neighbours.lists;
        start.push(0);
        let any_opposed = chunks.iter().any(|chunk| chunk.any_opposed);
        for chunk in chunks {
            monitor.check()?;
            let first = items.len() as u32;
            start.extend(chunk.ends.iter().map(|end| first + end));
            items.extend_from_slice(&chunk.items);
            links.border_edges.extend_from_slice(&chunk.border_edges);
        }
        if any_opposed {
            links.neighbours.is_reversed =
                reversed_in_sheet(mesh, corners_of, &links.neighbours, monitor)?;
        }
        Ok(links)
    }

    /// Takes the sides of cracks of no width from the border edges: where a mesh was refined in some places, small
    /// elements hang on the edge of a large one. O(border elements · log of them).
    fn leave_out_cracks(
        &mut self,
        mesh: &ShellMesh,
        merged: &[u32],
        corners_of: &[[u32; 4]],
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let (mut elements, mut sides) = (Vec::new(), Vec::new());
        let (mut place, mut positions, mut triangles) = (HashMap::new(), Vec::new(), Vec::new());
        for_chunks(mesh.len(), monitor, |range| {
            for element in range.filter(|&element| self.border_edges[element] != 0) {
                elements.push(element);
                for triangle in mesh.halves(element).into_iter().flatten() {
                    triangles.push(triangle.map(|node| {
                        *place.entry(merged[node as usize]).or_insert_with(|| {
                            positions.push(mesh.positions()[node as usize]);
                            positions.len() as u32 - 1
                        })
                    }));
                }
            }
        })?;
        // The two ends of a side of an element on the border, the smaller one first.
        let ends = |corners: &[u32; 4], [i, j]: [usize; 2]| -> Option<[u32; 2]> {
            let [a, b] = [place.get(&corners[i])?, place.get(&corners[j])?];
            Some([*a.min(b), *a.max(b)])
        };
        for &element in &elements {
            let corners = &corners_of[element];
            let bits = self.border_edges[element];
            let on_border = edges(corners).filter(|[i, _]| bits & (1 << i) != 0);
            sides.extend(on_border.filter_map(|edge| ends(corners, edge)));
        }
        sides.sort_unstable();
        // Triangles without area are none, and the others have finite corners.
        let Ok(around) = TriMesh::new(positions, triangles) else {
            return Ok(());
        };
        let topology = Topology::build(&around, monitor)?;
        let mut border: Vec<u32> = (0..topology.edges.len() as u32).collect();
        border.retain(|&edge| sides.binary_search(&topology.edges[edge as usize]).is_ok());
        let kept = without_cracks(&around, &topology, border.clone(), monitor)?;
        let mut closed: Vec<[u32; 2]> = border
            .into_iter()
            .filter(|edge| kept.binary_search(edge).is_err())
            .map(|edge| topology.edges[edge as usize])
            .collect();
        closed.sort_unstable();
        for element in elements {
            let corners = &corners_of[element];
            for edge in edges(corners) {
                if ends(corners, edge).is_some_and(|ends| closed.binary_search(&ends).is_ok()) {
                    self.border_edges[element] &= !(1 << edge[0]);
                }
            }
        }
        Ok(())
    }

    /// True if the edge of an element between two of its nodes lies on the border; a diagonal never
    /// does.
    pub(super) fn is_border_edge(
        &self,
        element: usize,
        corners: &[u32; 4],
        ends: [u32; 2],
    ) -> bool {
        let bits = self.border_edges[element];
        bits != 0
            && edges(corners).any(|[i, j]| {
                let own = [corners[i], corners[j]];
                bits & (1 << i) != 0 && (own == ends || own == [ends[1], ends[0]])
            })
    }

    /// True if a node lies on the border.
    pub(super) fn is_border_node(&self, node: u32) -> bool {
        self.is_border_node[node as usize]
    }
}

fn n_merged(merged: &[u32]) -> usize {
    let last = merged.iter().filter(|&&v| v != u32::MAX).max();
    last.map_or(0, |&v| v as usize + 1)
}

/// The corners of each element by their merged nodes.
fn merged_corners(
    mesh: &ShellMesh,
    merged: &[u32],
    monitor: &Monitor,
) -> Result<Vec<[u32; 4]>, Cancelled> {
    map_chunks(mesh.len(), monitor, |element| {
        mesh.corners()[element].map(|node| merged[node as usize])
    })
}

/// For each element whether its corners go the other way round than those of most of its sheet, by area, from the
/// neighbours of all elements. A sheet goes on over edges that two elements of one part share and no
/// third: beyond others no side is the same.
fn reversed_in_sheet(
    mesh: &ShellMesh,
    corners_of: &[[u32; 4]],
    neighbours: &Neighbours,
    monitor: &Monitor,
) -> Result<Vec<bool>, Cancelled> {
    let across = |element: usize, ends: [u32; 2]| {
        let others = neighbours.of(element).iter().map(|&other| other as usize);
        let mut others = others.filter_map(|other| {
            let same_way = goes_along(&corners_of[other], ends)?;
            (mesh.areas()[other] > 0.0).then_some((other, same_way))
        });
        let only = others.next().filter(|_| others.next().is_none());
        only.filter(|(other, _)| mesh.parts()[*other] == mesh.parts()[element])
    };
    let mut is_reversed: Vec<Option<bool>> = vec![None; mesh.len()];
    let mut sheet = Vec::new();
    for first in 0..mesh.len() {
        if is_reversed[first].is_some() {
            continue;
        }
        is_reversed[first] = Some(false);
        sheet.clear();
        sheet.push(first);
        let (mut areas, mut at) = ([0.0; 2], 0);
        while let Some(&element) = sheet.get(at) {
            if at.is_multiple_of(CHUNK) {
                monitor.check()?;
            }
            at += 1;
            let own = is_reversed[element] == Some(true);
            areas[usize::from(own)] += mesh.areas()[element];
            let corners = &corners_of[element];
            for ends in edges(corners).map(|[i, j]| [corners[i], corners[j]]) {
                if let Some((other, same_way)) = across(element, ends)
                    && is_reversed[other].is_none()
                {
                    is_reversed[other] = Some(own != same_way);
                    sheet.push(other);
                }
            }
        }
        if areas[1] > areas[0] {
            for &element in &sheet {
                is_reversed[element] = is_reversed[element].map(|own| !own);
            }
        }
    }
    Ok(is_reversed.into_iter().map(|r| r == Some(true)).collect())
}

/// The edges of an element by the places of their corners; a triangle has three.
fn edges(corners: &[u32; 4]) -> impl Iterator<Item = [usize; 2]> + use<> {
    let n = if corners[2] == corners[3] { 3 } else { 4 };
    // Without a division, which would take most of the time.
    (0..n).map(move |i| [i, if i + 1 < n { i + 1 } else { 0 }])
}

/// Links of some elements that follow each other.
struct Chunk {
    ends: Vec<u32>,
    items: Vec<u32>,
    border_edges: Vec<u8>,
    /// Two elements go along their common edge the same way, so that their normals point to opposite sides.
    any_opposed: bool,
}

impl Chunk {
    fn of(
        first: usize,
        chunk: &[[u32; 4]],
        (around_node, around_edge): (&Lists, &CrowdedEdges),
        corners_of: &[[u32; 4]],
        has_area: impl Fn(u32) -> bool,
    ) -> Self {
        let mut links = Self {
            ends: Vec::with_capacity(chunk.len()),
            items: Vec::with_capacity(8 * chunk.len()),
            border_edges: Vec::with_capacity(chunk.len()),
            any_opposed: false,
        };
        let mut found = Vec::new();
        for (element, corners) in (first..).zip(chunk) {
            let element = element as u32;
            found.clear();
            for &node in corners {
                let around = around_node.of(node as usize);
                if around.len() <= MOST_AT_NODE {
                    found.extend(around.iter().filter(|&&other| other != element));
                }
            }
            let mut bits = 0;
            for [i, j] in edges(corners) {
                let ends = [corners[i], corners[j]];
                // An edge of no length is none.
                if ends[0] == ends[1] {
                    continue;
                }
                let [a, b] = ends.map(|end| around_node.of(end as usize));
                let shorter = if b.len() < a.len() { b } else { a };
                let is_crowded = shorter.len() > MOST_AT_NODE;
                let around = if is_crowded {
                    around_edge.of_edge(ends)
                } else {
                    shorter
                };
                let others = around.iter().filter(|&&other| other != element);
                let mut others = others.filter_map(|&other| {
                    Some((other, goes_along(&corners_of[other as usize], ends)?))
                });
                if is_crowded && around.len() <= MOST_AT_EDGE {
                    found.extend(others.clone().map(|(other, _)| other));
                }
                let across = others.find(|(other, _)| has_area(*other));
                bits |= u8::from(across.is_none()) << i;
                links.any_opposed |= across.is_some_and(|(_, same_way)| same_way);
            }
            links.border_edges.push(bits);
            found.sort_unstable();
            found.dedup();
            links.items.extend_from_slice(&found);
            links.ends.push(links.items.len() as u32);
        }
        links
    }
}

/// The elements at each edge between two nodes of more than [`MOST_AT_NODE`] elements, those with an area first.
struct CrowdedEdges {
    /// The ends of each edge, the smaller one first, once for every element at it.
    ends: Vec<[u32; 2]>,
    elements: Vec<u32>,
}

impl CrowdedEdges {
    fn of(
        corners_of: &[[u32; 4]],
        around_node: &Lists,
        has_area: impl Fn(u32) -> bool,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let is_crowded = |node: u32| around_node.of(node as usize).len() > MOST_AT_NODE;
        let mut found = Vec::new();
        for_chunks(corners_of.len(), monitor, |range| {
            for element in range {
                let corners = &corners_of[element];
                for [i, j] in edges(corners) {
                    let ends = sorted([corners[i], corners[j]]);
                    if ends.into_iter().all(is_crowded) {
                        found.push((ends, !has_area(element as u32), element as u32));
                    }
                }
            }
        })?;
        found.sort_unstable();
        Ok(Self {
            ends: found.iter().map(|(ends, ..)| *ends).collect(),
            elements: found.iter().map(|(.., element)| *element).collect(),
        })
    }

    fn of_edge(&self, ends: [u32; 2]) -> &[u32] {
        let ends = sorted(ends);
        let first = self.ends.partition_point(|other| *other < ends);
        let n = self.ends[first..].partition_point(|other| *other == ends);
        &self.elements[first..first + n]
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Whether an element goes along an edge from its first end to its second; `None` if it has no such edge.
fn goes_along(corners: &[u32; 4], ends: [u32; 2]) -> Option<bool> {
    edges(corners).find_map(|[i, j]| match [corners[i], corners[j]] {
        own if own == ends => Some(true),
        [from, to] if [to, from] == ends => Some(false),
        _ => None,
    })
}

/// The elements around each element.
#[derive(Debug, Clone)]
pub struct Neighbours {
    lists: Lists,
    /// Of each element, whether its corners go the other way round than those of most of its sheet; empty where all go
    /// alike.
    is_reversed: Vec<bool>,
}

impl Neighbours {
    /// Elements that share a node with `element`, in rising order; of a node with more than 128 elements those that
    /// share an edge, unless many do.
    pub fn of(&self, element: usize) -> &[u32] {
        self.lists.of(element)
    }

    /// True if any two elements that share an edge have their normals on opposite sides.
    pub(super) fn any_opposed(&self) -> bool {
        !self.is_reversed.is_empty()
    }

    /// For each element whether its corners go the other way round than those of most of its sheet, by area; empty
    /// where all go alike.
    pub(super) fn reversed(&self) -> &[bool] {
        &self.is_reversed
    }

    /// True if two elements of one sheet have their normals on opposite sides of it. What a fold does to normals
    /// does not count.
    pub fn are_opposed(&self, a: usize, b: usize) -> bool {
        self.is_reversed.get(a) != self.is_reversed.get(b)
    }

    /// The cosine between the normals of two elements of one sheet as one side of it has them.
    pub fn seen_cos(&self, a: usize, b: usize, cos: f64) -> f64 {
        if self.are_opposed(a, b) { -cos } else { cos }
    }
}

/// Lists of different lengths stored one after another.
#[derive(Debug, Clone, Default)]
struct Lists {
    start: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// Groups items `0..n_items` by the lists they belong to, in rising order.
    fn group<I: Iterator<Item = u32>>(
        [n_lists, n_items]: [usize; 2],
        lists_of: impl Fn(usize) -> I,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut start = vec![0_u32; n_lists + 1];
        for_chunks(n_items, monitor, |range| {
            for list in range.flat_map(&lists_of) {
                start[list as usize + 1] += 1;
            }
        })?;
        for list in 0..n_lists {
            start[list + 1] += start[list];
        }
        let mut next = start.clone();
        let mut items = vec![0; start[n_lists] as usize];
        for_chunks(n_items, monitor, |range| {
            for item in range {
                for list in lists_of(item) {
                    items[next[list as usize] as usize] = item as u32;
                    next[list as usize] += 1;
                }
            }
        })?;
        Ok(Self { start, items })
    }

    /// The items of a list; none of one that is not there.
    fn of(&self, list: usize) -> &[u32] {
        let range = self.start.get(list..list.saturating_add(2));
        range.map_or(&[], |ends| &self.items[ends[0] as usize..ends[1] as usize])
    }
}

#[cfg(test)]
mod tests;
