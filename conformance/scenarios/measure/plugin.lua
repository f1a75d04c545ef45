function TestCase.run()
  rtf.measure("position error", 0.02, "rad", nil, 0.05)
  rtf.measure("rate", 87.5, "Hz", 95, 105)
end
