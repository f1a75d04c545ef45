function TestCase.run()
  rtf.case("gripper", function()
    rtf.skip("no gripper is mounted")
  end)
  rtf.case("arm", function() end)
end
