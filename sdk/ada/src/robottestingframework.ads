--  SPDX-License-Identifier: Apache-2.0
--  Write tests and fixtures for the Robot Testing Framework in Ada.
--
--  A test derives from TestCase.TestCase, a fixture from
--  FixtureManager.FixtureManager. They call Asserter (checks and assertions), Cases and
--  Session (parameters, waiting, measurements).

package RobotTestingFramework is

   --  A plug-in that does not instantiate TestCase.Register exports a procedure with
   --  this name, which calls TestCase.SetTest.
   Test_Create_Symbol : constant String := "robottestingframework_test_create";

   --  A failed assertion or a skip, which was reported before this is raised. Ends the
   --  innermost case, or a step of the plug-in.
   Assertion_Ended : exception;

   --  A failed critical assertion, in the same way. Ends the step also in a case.
   Critical_Assertion_Ended : exception;

   --  The runner asked the plug-in to stop. Ends a step of the plug-in.
   Stop_Requested : exception;

end RobotTestingFramework;
