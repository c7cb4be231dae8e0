"""Ways out: the answer document as JSON, pictures (SVG, matplotlib), drawings (DXF), GeoJSON."""
