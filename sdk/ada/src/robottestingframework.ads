--  SPDX-License-Identifier: Apache-2.0
--  Write tests and fixtures for the Robot Testing Framework in Ada.
--
--  A test derives from TestCase.TestCase, a fixture from
--  FixtureManager.FixtureManager; what they may call is in Asserter (what they
--  find out) and in Session (what the suite says, waiting, measurements).

package RobotTestingFramework is

   --  The procedure that makes the plug-in's test, for those who export one
   --  under this name and call TestCase.SetTest in it. Others instantiate
   --  TestCase.Register.
   Test_Create_Symbol : constant String := "robottestingframework_test_create";

   --  An assertion did not hold, which was reported before this was raised. It
   --  ends a step of the plug-in.
   Assertion_Ended : exception;

   --  The runner asked the plug-in to stop. It ends a step of the plug-in.
   Stop_Requested : exception;

end RobotTestingFramework;
