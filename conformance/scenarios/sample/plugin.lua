function TestCase.run()
  rtf.sample("elbow", 0.25, "rad", nil, 1.5, 0.5)
  rtf.sample("current", 2, "", nil, nil, 0.5)
  rtf.sample("elbow", 1.5, "rad", nil, 1.5, 1)
  rtf.report("what was sampled comes before")
  local taken = 0
  rtf.sample_for("ramp", 0.05, 20, function()
    taken = taken + 1
    return taken
  end)
  rtf.sample("elbow", 1.75, "rad", -1.5, 1.5, 1.25)
  rtf.sample("elbow", 2, "rad", -1.5, 1.5, 1.5)
end
