"""The driveline in the browser: ``trunnion app``. Every number it shows is that of a public function."""
