//! Figures as pixels, for text processors that draw no SVG.

use std::{collections::BTreeSet, sync::Arc};

use png::{BitDepth, ColorType, Compression, Encoder, PixelDimensions, Unit};
use resvg::{
    render,
    tiny_skia::{Color, Pixmap},
    usvg::{Group, Node, Options, Transform, Tree, fontdb::Database},
};

const INCHES_M: f64 = 1.0 / 0.0254;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Raster {
    pub(crate) png: Vec<u8>,
    /// What the font lacks, and is drawn as a box.
    pub(crate) lacking: BTreeSet<String>,
}

/// An SVG document of a size on paper as a PNG file of so many dots per inch, on white.
///
/// Text is set in a font that is part of the program: the result depends on no machine.
pub(crate) fn raster(
    svg: &str,
    dots_per_inch: u32,
) -> Result<Raster, Box<dyn std::error::Error + Send + Sync>> {
    let mut fonts = Database::new();
    fonts.load_font_data(ttf_noto_sans::REGULAR.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    fonts.set_sans_serif_family(family.unwrap_or_default());
    #[expect(clippy::cast_possible_truncation, reason = "a few hundred")]
    let options =
        Options { dpi: f64::from(dots_per_inch) as f32, fontdb: Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| format!("no memory for {} x {} pixels", size.width(), size.height()))?;
    pixels.fill(Color::WHITE);
    let exact = Transform::from_scale(
        size.width() as f32 / tree.size().width(),
        size.height() as f32 / tree.size().height(),
    );
    render(&tree, exact, &mut pixels.as_mut());
    // Nothing shows through white.
    let colours: Vec<u8> =
        pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, size.width(), size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most some ten thousands")]
    let per_metre = (f64::from(dots_per_inch) * INCHES_M).round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions { xppu: per_metre, yppu: per_metre, unit: Unit::Meter }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    let mut lacking = BTreeSet::new();
    lacks(tree.root(), &mut lacking);
    Ok(Raster { png: file, lacking })
}

fn lacks(group: &Group, lacking: &mut BTreeSet<String>) {
    /// The first glyph of every font.
    const BOX: u32 = 0;
    for node in group.children() {
        match node {
            Node::Group(inner) => lacks(inner, lacking),
            Node::Text(text) => {
                let glyphs = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
                lacking.extend(glyphs.filter(|glyph| glyph.id.0 == BOX).map(|glyph| glyph.text.clone()));
            }
            Node::Path(_) | Node::Image(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dark pixels of a document of one inch by one with this within.
    fn dark(inner: &str) -> (usize, usize) {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='25.4mm' height='25.4mm' viewBox='0 0 100 100'>{inner}</svg>"
        );
        let Raster { png: file, lacking } = raster(&svg, 200).unwrap();
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let shape = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((shape.width, shape.height), (200, 200));
        (pixels.chunks(3).filter(|rgb| rgb.iter().all(|value| *value < 128)).count(), lacking.len())
    }

    #[test]
    fn text_is_drawn_with_no_font_on_the_machine_and_what_the_font_lacks_is_told() {
        let text = |text: &str| {
            dark(&format!("<text x='5' y='80' font-family='sans-serif' font-size='60'>{text}</text>"))
        };
        assert_eq!(dark(""), (0, 0));
        for sign in ["A", "\u{b0}", "\u{b3}", "\u{2212}", "\u{2026}", "\u{3b1}"] {
            let (dark, lacking) = text(sign);
            assert!(dark > 50 && lacking == 0, "{sign}: {dark}, {lacking}");
        }
        assert_eq!(text("\u{6f22}").1, 1);
    }

    #[test]
    fn what_is_no_document_is_an_error() {
        assert!(raster("<svg", 300).is_err());
    }
}
