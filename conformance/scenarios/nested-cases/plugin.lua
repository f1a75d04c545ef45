function TestCase.run()
  rtf.case("Arm", function()
    rtf.case("Moves", function()
      rtf.check(false, "it moves")
    end)
    rtf.case("Stops", function() end)
  end)
  rtf.case("Hand", function() end)
end
