"""Programs of 3D printers: Marlin, with the words of Klipper and RepRapFirmware that differ."""
