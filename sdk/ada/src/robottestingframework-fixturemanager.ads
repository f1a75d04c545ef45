--  SPDX-License-Identifier: Apache-2.0
--  Fixtures: what has to run while tests do, such as a simulator or a driver.

private with RobotTestingFramework.Registry;

package RobotTestingFramework.FixtureManager is

   --  Each plug-in has a copy of this type. A process may hold several of them.
   pragma Suppress (Duplicated_Tag_Check);

   --  An attempt of a test, of which a fixture is told.
   type Test (Length : Natural) is record
      Id         : Natural;
      Repetition : Positive;
      Attempt    : Positive;
      Name       : String (1 .. Length);
   end record;

   type FixtureManager is abstract tagged private;
   type FixtureManager_Access is access all FixtureManager'Class;

   --  Brings the fixture up. Parameters is the parameter string as it stands in
   --  the suite. False means that it failed.
   function Setup (Self : in out FixtureManager; Parameters : String) return Boolean is abstract;

   --  Looks whether the fixture is well, before each test and while tests run.
   --  False means that it collapsed.
   function Check (Self : in out FixtureManager) return Boolean;

   --  Hears that a test is about to begin. False: the fixture collapsed.
   function TestStarted (Self : in out FixtureManager; Told : Test) return Boolean;

   --  Hears how a test was judged: `passed`, `failed`, `error`, `crashed`, ... What
   --  is reported, measured and attached here belongs to that test.
   function TestFinished
     (Self : in out FixtureManager; Told : Test; Verdict, Reason : String) return Boolean;

   --  Brings it down, also after a Setup that failed.
   procedure TearDown (Self : in out FixtureManager) is null;

   --  Tells at once, from any task, that the fixture is not well any more.
   procedure Collapsed (Reason : String);

   --  Declares the plug-in's fixture.
   generic
      type Fixture is new FixtureManager with private;
   package Register is
   private
      procedure Make;
      Kept : constant Boolean := Registry.Keep (Make'Access);
   end Register;

   --  Makes this the plug-in's fixture.
   procedure SetFixture (Fixture : FixtureManager_Access);

   --  The plug-in's fixture, if it is one.
   function Current return FixtureManager_Access;

private

   type FixtureManager is abstract tagged null record;

end RobotTestingFramework.FixtureManager;
