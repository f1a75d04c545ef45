function TestCase.run()
  rtf.case("dangerous", function()
    rtf.require_critical(false, "the arm is free")
  end)
  rtf.case("never", function()
    rtf.report("never")
  end)
end
