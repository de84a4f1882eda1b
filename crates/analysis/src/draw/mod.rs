//! Parts that all figures and pages share: style sheets, axes, marks, labels and numbers.

pub(crate) mod axis;
pub(crate) mod html;
pub(crate) mod labels;
pub(crate) mod marks;
pub mod number;
pub(crate) mod plot;
#[cfg(test)]
pub(crate) mod xml;

pub use axis::Scale;

/// Style of an SVG figure, for light and dark colour schemes.
pub(crate) const STYLE: &str = "\
.tv{font:12px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
.tv-page{fill:#ffffff}.tv-ink{fill:#1f2328}.tv-soft{fill:#57606a}.tv-small{font-size:11px}.tv-title{font-size:13px;font-weight:600}\
.tv-grid{stroke:#e1e5ea;stroke-width:1}.tv-frame{stroke:#8b949e;stroke-width:1;fill:none}\
.tv-front{stroke:#57606a;stroke-width:1.5;stroke-dasharray:5 4;fill:none}\
.tv-line{stroke-width:1;stroke-opacity:.45;fill:none}.tv-bar{stroke-width:1.2;stroke-opacity:.7}.tv-mark{stroke-width:1.8}\
.tv-s0{stroke:#0b62b8;fill:#0b62b8}.tv-s1{stroke:#c2410c;fill:#c2410c}.tv-s2{stroke:#0f7b5a;fill:#0f7b5a}\
.tv-s3{stroke:#9b3e8f;fill:#9b3e8f}.tv-s4{stroke:#8a6a00;fill:#8a6a00}.tv-s5{stroke:#475569;fill:#475569}\
.tv-open{fill:#ffffff}.tv-none{fill:none}\
@media (prefers-color-scheme:dark){\
.tv-page{fill:#181b20}.tv-ink{fill:#e6e8eb}.tv-soft{fill:#a9b1bb}\
.tv-grid{stroke:#2b3038}.tv-frame{stroke:#6b7480}.tv-front{stroke:#c3c9d1}\
.tv-s0{stroke:#6cb4ff;fill:#6cb4ff}.tv-s1{stroke:#ff9a62;fill:#ff9a62}.tv-s2{stroke:#4fd1a1;fill:#4fd1a1}\
.tv-s3{stroke:#e79bdc;fill:#e79bdc}.tv-s4{stroke:#e3c04d;fill:#e3c04d}.tv-s5{stroke:#b6c2d1;fill:#b6c2d1}\
.tv-open{fill:#181b20}.tv-none{fill:none}}";

/// Text with the special characters of XML escaped and control characters replaced by spaces.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
