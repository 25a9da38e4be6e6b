//! Joint positions and energy of the first world over time, drawn to PNG and SVG.

use crate::trajectory::Trajectory;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::io::Write;

/// Size of the plot [pixel].
const SIZE: (u32, u32) = (1280, 960);
/// The PNG is drawn this many times larger and then averaged, which smooths its lines.
const OVERSAMPLING: u32 = 3;
/// Most curves of joint positions, those that move most.
const MOST_CURVES: usize = 8;
/// What moves by less [m or rad] has no curve, if others have.
const STILL: f64 = 1e-6;
/// Most points of a curve.
const MOST_POINTS: usize = 2000;

/// Around a panel, before its left edge, and above it [pixel].
const MARGIN: i32 = 16;
const BEFORE_PANEL: i32 = 88;
const ABOVE_PANEL: i32 = 40;

/// Colours that the colour-blind can tell apart (Okabe and Ito 2008), with a grey for yellow.
const COLOURS: [RGBColor; MOST_CURVES] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(100, 100, 100),
    RGBColor(0, 0, 0),
];
const INK: RGBColor = RGBColor(45, 50, 60);
const GRID: RGBColor = RGBColor(226, 229, 234);
const FONT: &str = "sans-serif";

/// Why a plot cannot be drawn.
pub type PlotError = Box<dyn std::error::Error + Send + Sync>;

/// Writes the plot as scalable vector graphics.
pub fn write_svg(
    title: &str,
    trajectory: &Trajectory,
    mut file: impl Write,
) -> Result<(), PlotError> {
    let mut text = String::new();
    draw(
        SVGBackend::with_string(&mut text, SIZE).into_drawing_area(),
        1,
        title,
        trajectory,
    )?;
    Ok(file.write_all(text.as_bytes())?)
}

/// Writes the plot as pixels.
pub fn write_png(title: &str, trajectory: &Trajectory, file: impl Write) -> Result<(), PlotError> {
    let (width, height) = (SIZE.0 * OVERSAMPLING, SIZE.1 * OVERSAMPLING);
    let mut large = vec![0; 3 * (width * height) as usize];
    let area = BitMapBackend::with_buffer(&mut large, (width, height)).into_drawing_area();
    draw(area, OVERSAMPLING, title, trajectory)?;

    let mut encoder = png::Encoder::new(file, SIZE.0, SIZE.1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&averaged(&large))?;
    Ok(writer.finish()?)
}

/// Averages squares of [`OVERSAMPLING`] pixels a side.
fn averaged(large: &[u8]) -> Vec<u8> {
    let (n, width) = (OVERSAMPLING as usize, SIZE.0 as usize);
    let mean = |i: usize| {
        let (y, x, channel) = (i / (3 * width), i / 3 % width, i % 3);
        let row = |dy: usize| 3 * n * ((n * y + dy) * width + x) + channel;
        let sum: usize = (0..n * n)
            .map(|k| usize::from(large[row(k / n) + 3 * (k % n)]))
            .sum();
        (sum / (n * n)) as u8
    };
    (0..large.len() / (n * n)).map(mean).collect()
}

/// A line of a panel: where it breaks, a new stretch begins.
struct Curve {
    label: String,
    colour: RGBColor,
    stretches: Vec<Vec<(f64, f64)>>,
}

impl Curve {
    fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.stretches.iter().flatten().copied()
    }
}

fn draw<B: DrawingBackend>(
    area: DrawingArea<B, Shift>,
    scale: u32,
    title: &str,
    trajectory: &Trajectory,
) -> Result<(), PlotError>
where
    B::ErrorType: 'static,
{
    let font = epaint_default_fonts::UBUNTU_LIGHT;
    register_font(FONT, FontStyle::Normal, font).map_err(|_| "the built-in font is damaged")?;
    let s = scale as i32;
    let (positions, unit) = position_curves(trajectory);
    let energies = energy_curves(trajectory);
    let labels = positions
        .iter()
        .chain(&energies)
        .map(|c| c.label.chars().count());
    let legend_width = 80 + 9 * labels.max().unwrap_or(0) as u32;
    let pen = Pen {
        scale,
        legend_width,
    };
    area.fill(&WHITE).map_err(failed)?;
    let heading = pen.text(26, INK).pos(Pos::new(HPos::Left, VPos::Top));
    area.draw_text(title, &heading, (24 * s, 20 * s))
        .map_err(failed)?;
    let (_, panels) = area.split_vertically(64 * s);
    let (upper, lower) = panels.split_vertically(panels.dim_in_pixel().1 as i32 / 2);
    pen.panel(&upper, &format!("joint position{unit}"), &positions)?;
    pen.panel(&lower, "energy [J]", &energies)?;
    area.present().map_err(failed)
}

fn failed(error: impl std::error::Error) -> PlotError {
    error.to_string().into()
}

/// Draws at a scale, with room for legends of a width [pixel before scaling].
#[derive(Clone, Copy)]
struct Pen {
    scale: u32,
    legend_width: u32,
}

impl Pen {
    fn text(self, size: u32, colour: RGBColor) -> TextStyle<'static> {
        (FONT, size * self.scale).into_font().color(&colour)
    }

    fn panel<B: DrawingBackend>(
        self,
        area: &DrawingArea<B, Shift>,
        title: &str,
        curves: &[Curve],
    ) -> Result<(), PlotError>
    where
        B::ErrorType: 'static,
    {
        let s = self.scale;
        let (width, _) = area.dim_in_pixel();
        let (chart, legend) = area.split_horizontally(width - self.legend_width * s);
        let heading = self.text(19, INK).pos(Pos::new(HPos::Left, VPos::Top));
        area.draw_text(title, &heading, (BEFORE_PANEL * s as i32, 6 * s as i32))
            .map_err(failed)?;
        let times = range(curves.iter().flat_map(Curve::points).map(|p| p.0), 0.0);
        let values = range(curves.iter().flat_map(Curve::points).map(|p| p.1), 0.06);
        let mut chart = ChartBuilder::on(&chart)
            .margin(MARGIN * s as i32)
            .margin_top(ABOVE_PANEL * s as i32)
            .x_label_area_size(48 * s)
            .y_label_area_size((BEFORE_PANEL - MARGIN) * s as i32)
            .build_cartesian_2d(times, values)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(s))
            .axis_style(INK.stroke_width(s))
            .label_style(self.text(16, INK))
            .set_all_tick_mark_size(6 * s)
            .x_desc("time [s]")
            .axis_desc_style(self.text(17, INK))
            .x_label_formatter(&|x| label(*x))
            .y_label_formatter(&|y| label(*y))
            .draw()
            .map_err(failed)?;
        for curve in curves {
            for stretch in &curve.stretches {
                let line =
                    LineSeries::new(stretch.iter().copied(), curve.colour.stroke_width(2 * s));
                chart.draw_series(line).map_err(failed)?;
            }
        }
        self.legend(&legend, curves)
    }

    fn legend<B: DrawingBackend>(
        self,
        area: &DrawingArea<B, Shift>,
        curves: &[Curve],
    ) -> Result<(), PlotError>
    where
        B::ErrorType: 'static,
    {
        let s = self.scale as i32;
        let style = self.text(17, INK).pos(Pos::new(HPos::Left, VPos::Center));
        for (i, curve) in curves.iter().enumerate() {
            let y = (ABOVE_PANEL + 12 + 30 * i as i32) * s;
            let sample = [(0, y), (28 * s, y)];
            area.draw(&PathElement::new(
                sample,
                curve.colour.stroke_width(4 * self.scale),
            ))
            .map_err(failed)?;
            area.draw_text(&curve.label, &style, (38 * s, y))
                .map_err(failed)?;
        }
        Ok(())
    }
}

/// The coordinates of world 0 that move most, and the unit if all share it. Left out as long as
/// others move: where in the world a robot is, since a fall would dwarf all else; and the numbers of
/// orientations, which say little to the eye.
fn position_curves(t: &Trajectory) -> (Vec<Curve>, String) {
    let n = t.coordinates.len();
    let value = |row: usize, i: usize| t.joint_position[row * t.worlds * n + i];
    let span = |i: usize| {
        let values = (0..t.rows()).map(|row| value(row, i));
        let (low, high) = extent(values);
        high - low
    };
    let moving: Vec<usize> = (0..n).filter(|&i| span(i) > STILL).collect();
    let telling = |i: &usize| !t.coordinates[*i].base && !t.coordinates[*i].unit.is_empty();
    let mut chosen: Vec<usize> = moving.iter().copied().filter(telling).collect();
    if chosen.is_empty() {
        chosen = moving;
    }
    if chosen.is_empty() {
        chosen = (0..n).collect();
    }
    chosen.sort_by(|&a, &b| span(b).total_cmp(&span(a)));
    chosen.truncate(MOST_CURVES);
    chosen.sort_unstable();

    let units: Vec<&str> = chosen.iter().map(|&i| t.coordinates[i].unit).collect();
    let shared = units
        .first()
        .filter(|first| units.iter().all(|unit| unit == *first));
    let title = shared
        .filter(|unit| !unit.is_empty())
        .map_or(String::new(), |u| format!(" [{u}]"));
    let curve = |(k, &i): (usize, &usize)| {
        let coordinate = &t.coordinates[i];
        let label = match coordinate.unit {
            "m" | "rad" if shared.is_none() => {
                format!("{} [{}]", short(&coordinate.name), coordinate.unit)
            }
            _ => short(&coordinate.name),
        };
        let points = thinned(t).map(|row| (t.time[row], value(row, i)));
        let turn = if coordinate.unit == "rad" {
            std::f64::consts::PI
        } else {
            f64::INFINITY
        };
        Curve {
            label,
            colour: COLOURS[k],
            stretches: broken_at_jumps(points, turn),
        }
    };
    (chosen.iter().enumerate().map(curve).collect(), title)
}

fn energy_curves(t: &Trajectory) -> Vec<Curve> {
    let curve = |label: &str, k: usize, energy: &dyn Fn(usize) -> f64| Curve {
        label: label.into(),
        colour: COLOURS[k],
        stretches: vec![
            thinned(t)
                .map(|row| (t.time[row], energy(row * t.worlds)))
                .collect(),
        ],
    };
    let (kinetic, potential) = (&t.kinetic_energy, &t.potential_energy);
    vec![
        curve("kinetic", 1, &|i| kinetic[i]),
        curve("potential", 0, &|i| potential[i]),
        curve("total", 7, &|i| kinetic[i] + potential[i]),
    ]
}

/// Rows that are drawn.
fn thinned(t: &Trajectory) -> impl Iterator<Item = usize> {
    (0..t.rows()).step_by(t.rows().div_ceil(MOST_POINTS).max(1))
}

/// A turn past ±π is no motion across the panel.
fn broken_at_jumps(points: impl Iterator<Item = (f64, f64)>, jump: f64) -> Vec<Vec<(f64, f64)>> {
    let mut stretches: Vec<Vec<(f64, f64)>> = Vec::new();
    for point in points {
        match stretches.last_mut() {
            Some(stretch) if stretch.last().is_some_and(|p| (p.1 - point.1).abs() < jump) => {
                stretch.push(point);
            }
            _ => stretches.push(vec![point]),
        }
    }
    stretches
}

/// The least and the largest.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    })
}

/// From the least to the largest, widened by a share, and never empty.
fn range(values: impl Iterator<Item = f64>, share: f64) -> std::ops::Range<f64> {
    let (low, high) = extent(values);
    if low > high {
        return 0.0..1.0;
    }
    let room = share * (high - low);
    // Room for the labels of a constant, which rounding must not swallow.
    let least = 1e-6 * low.abs().max(high.abs()).max(1e-6);
    if high - low < least {
        low - least..high + least
    } else {
        low - room..high + room
    }
}

/// A number as it stands at an axis.
fn label(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

/// A name that fits beside a panel: of a long one its start, and its end, which tells x from y.
fn short(name: &str) -> String {
    const MOST: usize = 20;
    let name = name.replace("_free_position_", " ");
    let count = name.chars().count();
    if count <= MOST {
        return name;
    }
    let start: String = name.chars().take(MOST - 5).collect();
    let end: String = name.chars().skip(count - 4).collect();
    format!("{start}…{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_break_a_curve_and_motions_do_not() {
        let points = [(0.0, 3.0), (1.0, 3.1), (2.0, -3.1), (3.0, -3.0)];
        let stretches = broken_at_jumps(points.into_iter(), 3.0);
        assert_eq!(
            stretches,
            [vec![(0.0, 3.0), (1.0, 3.1)], vec![(2.0, -3.1), (3.0, -3.0)]]
        );
        assert_eq!(broken_at_jumps(points.into_iter(), f64::INFINITY).len(), 1);
    }

    #[test]
    fn ranges_are_never_empty() {
        assert_eq!(range([1.0, 3.0].into_iter(), 0.5), 0.0..4.0);
        for values in [vec![], vec![0.0], vec![5.0, 5.0], vec![-1e9, -1e9]] {
            let range = range(values.iter().copied(), 0.1);
            assert!(range.start < range.end, "{values:?}: {range:?}");
        }
    }

    #[test]
    fn long_names_keep_their_ends() {
        assert_eq!(short("ball_free_position_y"), "ball y");
        assert_eq!(
            short("left_shoulder_of_the_robot_x"),
            "left_shoulder_o…ot_x"
        );
    }

    #[test]
    fn labels_are_short() {
        assert_eq!(
            [0.0, -0.0, 1.5, -20.0, 1e-7, 2e6].map(label).join(" "),
            "0 0 1.5 -20 1.00e-7 2.00e6"
        );
    }
}
