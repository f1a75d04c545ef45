function TestCase.run()
  local limits = rtf.fixture_value("simulator.limits")
  if math.type(rtf.fixture_value("simulator.port")) ~= "integer"
    or rtf.fixture_value("simulator.port") ~= 40123
    or rtf.fixture_value("simulator.model") ~= "arm"
    or rtf.fixture_value("simulator.ready") ~= true
    or #limits ~= 2 or limits[1] ~= -1.5 or limits[2] ~= 1.5 then
    rtf.fail("wrong values")
  end
  if os.getenv("RTF_FIXTURE_SIMULATOR_PORT") ~= "40123" then
    rtf.fail("wrong port in the environment")
  end
  rtf.report("values read")
end
